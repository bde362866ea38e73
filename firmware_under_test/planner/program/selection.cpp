// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/selection.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "hil/base/text.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {
namespace {

constexpr dieline::Process kProcesses[] = {dieline::Process::kCut, dieline::Process::kHalfCut,
                                           dieline::Process::kCrease, dieline::Process::kPerforation};

bool holds(const EntityRanges& ranges, int id) { return ranges.empty() || contains(ranges, id); }

[[noreturn]] void refuse(const std::vector<std::string>& faults) {
  throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
}

/// Finds ranges that choose none of the ids.
void checkRanges(const Selection& selection, const std::set<int>& ids, std::vector<std::string>& faults) {
  for (const auto& [first, last] : selection.entities) {
    const auto found = ids.lower_bound(first);
    if (found != ids.end() && *found <= last) continue;
    const std::string range = first == last ? fmt::format("E{}", first) : fmt::format("E{}-E{}", first, last);
    faults.push_back(ids.empty() ? fmt::format("{}: nothing here belongs to an entity", range)
                                 : fmt::format("{}: there is no such entity; the ids go from {} to {}", range,
                                               *ids.begin(), *ids.rbegin()));
  }
}

/// Process word after the entity in a comment such as "(E14 half-cut)".
std::string processWordOf(std::string_view line, int entity) {
  const std::string text = base::lowered(line);
  const std::string key = fmt::format("e{} ", entity);
  const std::size_t at = text.find(key);
  if (entity < 0 || at == std::string::npos) return {};
  const std::size_t from = at + key.size();
  return text.substr(from, text.find_first_of(") \t\r", from) - from);
}

}  // namespace

Selection selectionFrom(const std::string& entities, const std::string& layers,
                        const std::string& processes) {
  Selection selection;
  std::vector<std::string> faults;
  try {
    selection.entities = entityRangesFrom(entities, "entities");
  } catch (const PlanError& error) {
    faults.emplace_back(error.what());
  }
  for (const std::string_view item : itemsOf(layers)) {
    if (item.empty()) {
      faults.emplace_back("layers: a name is missing between two commas");
    } else {
      selection.layers.insert(base::lowered(item));
    }
  }
  for (const std::string_view item : itemsOf(processes)) {
    const auto found = std::find_if(std::begin(kProcesses), std::end(kProcesses), [&](dieline::Process p) {
      return dieline::processName(p) == base::lowered(item);
    });
    if (found == std::end(kProcesses)) {
      faults.push_back(fmt::format("process: '{}' is none of cut, half-cut, crease, perforation", item));
    } else {
      selection.processes.insert(*found);
    }
  }
  if (!faults.empty()) refuse(faults);
  return selection;
}

void select(dieline::Dieline& dieline, const Selection& selection) {
  if (selection.all()) return;
  std::set<int> ids;
  std::set<std::string> layers;
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process == dieline::Process::kIgnore) continue;
    ids.insert(entity.id);
    layers.insert(base::lowered(entity.layer));
  }
  std::vector<std::string> faults;
  checkRanges(selection, ids, faults);
  for (const std::string& layer : selection.layers) {
    if (layers.count(layer) == 0)
      faults.push_back(
          fmt::format("{}: there is no such layer; there are {}", layer, fmt::join(layers, ", ")));
  }
  bool any = false;
  for (dieline::Entity& entity : dieline.entities) {
    const bool chosen =
        holds(selection.entities, entity.id) &&
        (selection.layers.empty() || selection.layers.count(base::lowered(entity.layer)) > 0) &&
        (selection.processes.empty() || selection.processes.count(entity.process) > 0);
    if (!chosen && entity.process != dieline::Process::kIgnore)
      entity.left_out = std::exchange(entity.process, dieline::Process::kIgnore);
    any = any || entity.process != dieline::Process::kIgnore;
  }
  if (faults.empty() && !any) faults.emplace_back("nothing is chosen: no entity is in all lists");
  if (!faults.empty()) refuse(faults);
}

std::string select(const std::string& gcode, const Selection& selection) {
  if (selection.all()) return gcode;
  if (!selection.layers.empty())
    refuse({"layers cannot be chosen in G-code, which does not hold them; choose by process or entity"});
  const std::vector<Segment> path = readGcode(gcode);
  std::vector<std::string_view> lines{""};
  const std::string_view text = gcode;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  std::set<int> ids;
  std::map<int, std::string> words;
  std::vector<std::vector<Segment>> pieces;
  for (const Segment& segment : path) {
    if (segment.jump) continue;
    if (segment.entity >= 0) ids.insert(segment.entity);
    const std::string word = processWordOf(lines.at(std::size_t(segment.line)), segment.entity);
    const bool wanted = std::any_of(selection.processes.begin(), selection.processes.end(),
                                    [&](dieline::Process p) { return dieline::processName(p) == word; });
    if (!holds(selection.entities, segment.entity) || !(selection.processes.empty() || wanted)) continue;
    words[segment.entity] = word;
    pieces.push_back({segment});
  }
  std::vector<std::string> faults;
  checkRanges(selection, ids, faults);
  if (faults.empty() && pieces.empty())
    faults.emplace_back("nothing is chosen: entities and processes are told by comments such as (E14 cut)");
  if (!faults.empty()) refuse(faults);
  return writeGcode(pieces, [&](int entity) { return words.at(entity); });
}

}  // namespace kerfbench::planner
