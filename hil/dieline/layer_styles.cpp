// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/layer_styles.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/svg_style.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// DXF colours 1 to 6, which are the pure ones of every program; 7 is black or white by the background.
constexpr std::array<std::string_view, 6> kPureColours{"#ff0000", "#ffff00", "#00ff00",
                                                       "#00ffff", "#0000ff", "#ff00ff"};

std::optional<Process> found(const std::map<std::string, Process>& rules, const std::string& key) {
  const auto rule = rules.find(key);
  return rule == rules.end() ? std::nullopt : std::optional(rule->second);
}

/// A colour as a person writes it in a rule.
std::string written(const std::string& colour) {
  const auto pure = std::find(kPureColours.begin(), kPureColours.end(), colour);
  if (pure == kPureColours.end()) return colour.starts_with('#') ? inQuotes(colour) : colour;
  return fmt::format("{}", pure - kPureColours.begin() + 1);
}

/// The styled rules of a layer, upper and lower case alike, else those of "*", unless a plain rule is nearer.
const StyleRules* styledRules(const LayerProfile& profile, std::string_view layer) {
  const std::string key = lowered(layer);
  for (const auto& [name, rules] : profile.styled) {
    if (name != "*" && lowered(name) == key) return &rules;
  }
  const auto others = profile.styled.find("*");
  return others == profile.styled.end() || hasRule(profile, layer) ? nullptr : &others->second;
}

}  // namespace

std::optional<std::string> normalColour(std::string_view text) {
  text = trimmed(text);
  if (const auto number = parsedNumber<int>(text)) {
    if (*number < 1 || *number > 255) return std::nullopt;
    if (*number <= 6) return std::string(kPureColours.at(static_cast<std::size_t>(*number - 1)));
    return fmt::format("{}", *number);
  }
  const auto colour = svgColour(text);
  return colour == "none" ? std::nullopt : colour;
}

std::string normalLinetype(std::string_view text) {
  std::string name = lowered(trimmed(text));
  return name == "solid" ? "continuous" : name;
}

std::optional<Process> LayerCensus::byStyle(const StyleRules& rules, std::string_view layer,
                                            const LineStyle& style, int line, std::string_view element,
                                            FaultList& faults) const {
  if (const auto both = found(rules.both, style.colour + " " + style.linetype)) return both;
  const auto by_colour = found(rules.colour, style.colour);
  const auto by_linetype = found(rules.linetype, style.linetype);
  if (by_colour && by_linetype && *by_colour != *by_linetype) {
    faults.add(line, fmt::format("{} on layer {} is {} by its colour and {} by its linetype; say which with "
                                 "layers: {{{}: {{both: {{'{} {}': …}}}}}}",
                                 element, inQuotes(layer), processName(*by_colour), processName(*by_linetype),
                                 inQuotes(layer), style.colour, style.linetype));
    return std::nullopt;
  }
  if (by_colour) return by_colour;
  if (by_linetype) return by_linetype;
  if (!rules.other) {
    faults.add(line, fmt::format("{} on layer {} has colour {} and linetype {}, for which the profile {} has "
                                 "no rule; a rule for what is left is layers: {{{}: {{other: …}}}}",
                                 element, inQuotes(layer), written(style.colour), inQuotes(style.linetype),
                                 inQuotes(profile_.name), inQuotes(layer)));
  }
  return rules.other;
}

std::optional<Process> LayerCensus::processOf(std::string_view layer, const LineStyle& style, int line,
                                              std::string_view element, FaultList& faults) {
  auto at = seen_.find(layer);
  if (at == seen_.end()) {
    const StyleRules* styled = styledRules(profile_, layer);
    at = seen_
             .emplace(std::string(layer),
                      Seen{styled ? std::nullopt : processFor(profile_, layer), styled, {}, {}, 0, 0})
             .first;
  }
  Seen& seen = at->second;
  if (seen.styled != nullptr) return byStyle(*seen.styled, layer, style, line, element, faults);
  if (!seen.process) {
    if (seen.without_rule++ == 0) {
      seen.first_element = element;
      seen.first_line = line;
    }
  } else if (*seen.process != Process::kIgnore) {
    seen.first_lines.try_emplace({style.colour, style.linetype}, line);
  }
  return seen.process;
}

void LayerCensus::refuse(FaultList& faults) const {
  for (const auto& [layer, seen] : seen_) {
    if (seen.without_rule > 0) {
      const std::string more =
          seen.without_rule > 1 ? fmt::format(" (and {} more on this layer)", seen.without_rule - 1) : "";
      faults.add(
          seen.first_line,
          fmt::format("{} on layer {}{}, for which the profile {} has no rule; a rule is "
                      "layers: {{{}: cut}}",
                      seen.first_element, inQuotes(layer), more, inQuotes(profile_.name), inQuotes(layer)));
    }
    if (seen.first_lines.size() > 1) refuseMixed(layer, seen, faults);
  }
}

void LayerCensus::refuseMixed(const std::string& layer, const Seen& seen, FaultList& faults) const {
  std::set<std::string> colours;
  std::set<std::string> linetypes;
  std::string styles;
  for (const auto& [style, line] : seen.first_lines) {
    colours.insert(written(style.first));
    linetypes.insert(style.second);
    if (colours.size() > 8 || linetypes.size() > 8) continue;
    styles += fmt::format("{}{} {} (line {})", styles.empty() ? "" : ", ", written(style.first), style.second,
                          line);
  }
  const bool by_colour = colours.size() > 1;
  const auto& values = by_colour ? colours : linetypes;
  std::string rule;
  for (const std::string& value : values) {
    if (rule.size() < 100) rule += fmt::format("{}{}: …", rule.empty() ? "" : ", ", value);
  }
  faults.add(0, fmt::format("layer {} mixes lines that are drawn differently: {}; say what each is for with "
                            "layers: {{{}: {{{}: {{{}}}}}}}, or that all are the same with layers: {{{}: "
                            "{{other: {}}}}}",
                            inQuotes(layer), styles, inQuotes(layer), by_colour ? "color" : "linetype", rule,
                            inQuotes(layer), processName(*seen.process)));
}

}  // namespace kerfbench::dieline
