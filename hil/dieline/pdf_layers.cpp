// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_layers.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

int byteOf(double share) { return static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * 255)); }

std::string hexOf(double red, double green, double blue) {
  return fmt::format("#{:02x}{:02x}{:02x}", byteOf(red), byteOf(green), byteOf(blue));
}

}  // namespace

std::string pdfStepName(const PdfGroup& group) {
  if (group.step_group.empty()) return "";
  return group.step_type.empty() ? group.step_group : group.step_group + " " + group.step_type;
}

std::optional<Process> pdfStepProcess(const PdfGroup& group) {
  const auto isOneOf = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), group.step_type) != names.end();
  };
  if (group.step_group != "Structural") {
    // All groups of the standard but Structural are print, or words about it.
    for (const char* name : {"Dimensions", "Braille", "Legend", "Positions", "White", "Varnish"}) {
      if (group.step_group == name) return Process::kIgnore;
    }
    return std::nullopt;
  }
  if (isOneOf({"Cutting"})) return Process::kCut;
  if (isOneOf({"PartialCutting"})) return Process::kHalfCut;
  if (isOneOf({"Creasing"})) return Process::kCrease;
  if (isOneOf({"Perforating"})) return Process::kPerforation;
  if (isOneOf({"Gluing", "FoilStamping", "ColdFoilStamping", "Embossing", "Debossing", "Bleed", "VarnishFree",
               "InkFree", "InkVarnishFree", "Folding", "Stapling"}))
    return Process::kIgnore;
  return std::nullopt;
}

std::vector<std::string> pdfColourNames(const PdfPaint& paint) {
  using Kind = PdfColourSpace::Kind;
  const auto& c = paint.components;
  switch (paint.space->kind) {
    case Kind::kGray:
      return {hexOf(c[0], c[0], c[0])};
    case Kind::kRgb:
      return {hexOf(c[0], c[1], c[2])};
    case Kind::kCmyk: {
      const auto percent = [&](std::size_t i) { return std::lround(std::clamp(c[i], 0.0, 1.0) * 100); };
      const double light = 1 - std::clamp(c[3], 0.0, 1.0);
      return {fmt::format("cmyk {} {} {} {}", percent(0), percent(1), percent(2), percent(3)),
              hexOf((1 - c[0]) * light, (1 - c[1]) * light, (1 - c[2]) * light)};
    }
    case Kind::kSpot: {
      std::vector<std::string> inks;
      for (std::size_t i = 0; i < paint.space->inks.size(); ++i) {
        if (c[i] > 0.0 && paint.space->inks[i] != "None") inks.push_back(paint.space->inks[i]);
      }
      if (inks.empty()) return {};
      return {fmt::format("{}", fmt::join(inks, "+"))};
    }
    default:
      return {
          fmt::format("colours of {}", paint.space->name.empty() ? "a kind not known" : paint.space->name)};
  }
}

PdfLayer choosePdfLayer(const PdfPaint& paint, const PdfDocument& document, const LayerProfile& profile) {
  std::vector<std::string> colours = pdfColourNames(paint);
  if (colours.empty()) return {.has_ink = false};
  std::vector<std::string> names;
  for (auto group = paint.groups.rbegin(); group != paint.groups.rend(); ++group) {
    const PdfGroup& g = document.groups[*group];
    const std::string step = pdfStepName(g);
    if (!step.empty()) {
      const auto process = hasRule(profile, step) ? processFor(profile, step) : pdfStepProcess(g);
      if (process) return {step, process, "", false, true};
      return {
          step, std::nullopt,
          fmt::format("is of the processing step {}, of which a laser does not know what to do; give {} a "
                      "rule",
                      inQuotes(step), inQuotes(step)),
          false, true};
    }
    names.push_back(g.name);
  }
  const std::size_t layers = names.size();
  for (std::string& colour : colours) names.push_back(std::move(colour));
  for (const std::string& name : names) {
    const std::string dashed = name + " dashed";
    if (paint.is_dashed && hasRule(profile, dashed))
      return {dashed, processFor(profile, dashed), "", false, true};
    if (hasRule(profile, name)) return {name, processFor(profile, name), "", true, true};
  }
  // The rule "*", if there is one. The colour is what tells strokes apart then.
  const std::string& colour = names[layers];
  PdfLayer layer{colour, processFor(profile, colour), "", true, true};
  if (!layer.process) {
    std::vector<std::string> quoted;
    for (const std::string& name : names) quoted.push_back(inQuotes(name));
    layer.fault = fmt::format("is known as {}, and the profile {} has a rule for none of them",
                              fmt::join(quoted, ", "), inQuotes(profile.name));
  }
  return layer;
}

}  // namespace kerfbench::dieline
