// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hil/dieline/read.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

const Process* ruleFor(const LayerProfile& profile, std::string_view layer) {
  if (layer == "*")
    return nullptr;  // A layer that is really called so must not pass as the rule for all others.
  const std::string key = lowered(layer);
  const auto rule = std::find_if(profile.rules.begin(), profile.rules.end(),
                                 [&](const auto& entry) { return lowered(entry.first) == key; });
  return rule == profile.rules.end() ? nullptr : &rule->second;
}

}  // namespace

LayerProfile defaultLayerProfile() {
  LayerProfile profile{"default", {}};
  const auto set = [&](Process process, std::initializer_list<const char*> names) {
    for (const char* name : names) profile.rules.emplace(name, process);
  };
  set(Process::kCut,
      {"0", "cut", "cuts", "cutting", "through-cut", "dieline", "die", "outline", "#000000", "#ff0000"});
  set(Process::kCrease, {"crease", "creases", "creasing", "fold", "folds", "score", "#0000ff", "#00ff00"});
  set(Process::kHalfCut, {"halfcut", "half-cut", "half_cut", "kiss", "kisscut", "kiss-cut", "#ff00ff"});
  set(Process::kPerforation, {"perf", "perforation", "perforate", "#00ffff"});
  set(Process::kIgnore, {"ignore", "dimension", "dimensions", "dims", "text", "notes", "annotation", "print",
                         "artwork", "defpoints"});
  // Types of lines of CF2, of which sources agree or nearly so (docs/reference/formats.md).
  set(Process::kCut, {"CF2 type 1"});
  set(Process::kCrease, {"CF2 type 2"});
  set(Process::kPerforation, {"CF2 type 3"});
  set(Process::kHalfCut, {"CF2 type 4"});
  set(Process::kIgnore, {"CF2 type 40", "CF2 type 43", "CF2 type 44", "CF2 type 46"});
  // Spot colours of PDF, as the makers of cutters ask for them.
  set(Process::kCut,
      {"CutContour", "Cut Contour", "Thru-Cut", "ThruCut", "Thru Cut", "Die Line", "Stanze", "Knife"});
  set(Process::kHalfCut, {"Kiss Cut", "PartialCut", "Partial Cut"});
  set(Process::kCrease, {"Creaseline", "Crease Line", "CreaseContour"});
  set(Process::kPerforation, {"PerfCutContour", "Perforating"});
  return profile;
}

std::optional<Process> processFor(const LayerProfile& profile, std::string_view layer) {
  if (const Process* rule = ruleFor(profile, layer)) return *rule;
  const auto others = profile.rules.find("*");
  if (others != profile.rules.end()) return others->second;
  return std::nullopt;
}

bool hasRule(const LayerProfile& profile, std::string_view layer) {
  const std::string key = lowered(layer);
  return ruleFor(profile, layer) != nullptr ||
         std::any_of(profile.styled.begin(), profile.styled.end(),
                     [&](const auto& entry) { return entry.first != "*" && lowered(entry.first) == key; });
}

}  // namespace kerfbench::dieline
