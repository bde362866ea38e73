// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/dieline/layer_styles.h"
#include "hil/dieline/read.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

std::optional<Process> processFromName(std::string_view name) {
  constexpr std::array kProcesses{Process::kCut, Process::kHalfCut, Process::kCrease, Process::kPerforation,
                                  Process::kIgnore};
  for (const Process process : kProcesses) {
    if (name == processName(process)) return process;
  }
  return std::nullopt;
}

/// "1 DASHED" as its colour and linetype are written once and for all; nothing for what is no such pair.
std::optional<std::string> normalBoth(std::string_view text) {
  text = trimmed(text);
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos) return std::nullopt;
  const auto colour = normalColour(text.substr(0, blank));
  const std::string linetype = normalLinetype(text.substr(blank));
  if (!colour || linetype.empty()) return std::nullopt;
  return *colour + " " + linetype;
}

}  // namespace

std::string addLayerRule(LayerProfile& profile, const std::vector<std::string>& path,
                         std::string_view process) {
  const auto found = processFromName(process);
  if (!found) {
    return fmt::format("'{}: {}' is none of cut, half-cut, crease, perforation, ignore",
                       fmt::join(path, ": "), process);
  }
  const std::string kind = path.size() > 1 ? path[1] : "";
  if (path.size() == 1) {
    profile.rules[path[0]] = *found;
  } else if (path.size() == 2 && kind == "other") {
    profile.styled[path[0]].other = *found;
  } else if (path.size() == 3 && (kind == "color" || kind == "colour")) {
    const auto colour = normalColour(path[2]);
    if (!colour)
      return fmt::format("{} is no colour: a number from 1 to 255, a name, or #rrggbb", inQuotes(path[2]));
    profile.styled[path[0]].colour[*colour] = *found;
  } else if (path.size() == 3 && kind == "linetype") {
    profile.styled[path[0]].linetype[normalLinetype(path[2])] = *found;
  } else if (path.size() == 3 && kind == "both") {
    const auto both = normalBoth(path[2]);
    if (!both) return fmt::format("{} is no colour and linetype such as '1 DASHED'", inQuotes(path[2]));
    profile.styled[path[0]].both[*both] = *found;
  } else {
    return fmt::format("'{}' is no rule: a layer has a process, or color, linetype, both and other",
                       fmt::join(path, ": "));
  }
  return {};
}

bool DrawingArguments::empty() const {
  return unit.empty() && page == 0 && scale == 1.0 && turn_deg == 0.0 && shift_mm.empty() && !once &&
         layers.empty();
}

DrawingOptions drawingOptionsFrom(const DrawingArguments& arguments) {
  DrawingOptions options;
  if (!arguments.unit.empty()) {
    options.unit = drawingUnitFromName(arguments.unit);
    if (!options.unit)
      throw DielineError(fmt::format("--unit {} is none of mm, cm, in, pt, px", inQuotes(arguments.unit)));
  }
  if (arguments.page < 0) throw DielineError("--page must be > 0");
  if (arguments.page > 0) options.page = arguments.page;
  // Beyond these a drawing has no place on any sheet, and a fault of it would not name the option.
  constexpr double kMost = 1e6;
  if (!(arguments.scale > 0 && arguments.scale <= kMost))
    throw DielineError(
        fmt::format("--scale must be > 0 and at most {:g}, but is {:g}", kMost, arguments.scale));
  if (!(std::abs(arguments.turn_deg) <= kMost))
    throw DielineError(
        fmt::format("--turn must be within ±{:g} degrees, but is {:g}", kMost, arguments.turn_deg));
  for (const double shift_mm : arguments.shift_mm)
    if (!(std::abs(shift_mm) <= kMost))
      throw DielineError(fmt::format("--shift must be within ±{:g} mm, but is {:g}", kMost, shift_mm));
  options.scale = arguments.scale;
  options.turn_deg = arguments.turn_deg;
  options.once = arguments.once;
  if (arguments.shift_mm.size() == 2) options.shift_mm = {arguments.shift_mm[0], arguments.shift_mm[1]};
  if (!arguments.layers.empty()) options.layers = {"command line", {}};
  for (const std::string& rule : arguments.layers) {
    const std::size_t equals = rule.rfind('=');
    if (equals == std::string::npos)
      throw DielineError(fmt::format("--layer {} is no LAYER=process", inQuotes(rule)));
    std::vector<std::string> path;
    std::string_view rest = std::string_view(rule).substr(0, equals);
    while (true) {
      const std::size_t slash = rest.find('/');
      path.emplace_back(rest.substr(0, slash));
      if (slash == std::string_view::npos) break;
      rest.remove_prefix(slash + 1);
    }
    const std::string fault = addLayerRule(options.layers, path, std::string_view(rule).substr(equals + 1));
    if (!fault.empty()) throw DielineError("--layer: " + fault);
  }
  return options;
}

}  // namespace kerfbench::dieline
