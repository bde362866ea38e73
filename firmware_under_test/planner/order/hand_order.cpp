// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/hand_order.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/order/cut_order.h"
#include "hil/dieline/outlines.h"

namespace kerfbench::planner {
namespace {

constexpr std::size_t kMostNamed = 20;
constexpr std::size_t kMostDoubts = 100;

/// "E3, E4 and 5 more".
std::string namesOf(const std::vector<int>& ids) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(ids.size(), kMostNamed); ++i)
    names.push_back(fmt::format("E{}", ids[i]));
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  if (ids.size() > kMostNamed) text += fmt::format(" and {} more", ids.size() - kMostNamed);
  return text;
}

bool isCutAtAll(const dieline::Entity& entity) { return entity.process != dieline::Process::kIgnore; }

/// Where each entity stands in an order.
std::map<int, std::size_t> placesOf(const std::vector<int>& order) {
  std::map<int, std::size_t> places;
  for (std::size_t i = 0; i < order.size(); ++i) places[order[i]] = i;
  return places;
}

}  // namespace

std::vector<std::string> orderFaults(const dieline::Dieline& dieline, const std::vector<int>& order) {
  std::map<int, const dieline::Entity*> drawn;
  for (const dieline::Entity& entity : dieline.entities) drawn[entity.id] = &entity;
  std::set<int> seen;
  std::vector<int> unknown, idle, twice, forgotten;
  for (const int id : order) {
    const auto found = drawn.find(id);
    if (!seen.insert(id).second) {
      twice.push_back(id);
    } else if (found == drawn.end()) {
      unknown.push_back(id);
    } else if (!isCutAtAll(*found->second)) {
      idle.push_back(id);
    }
  }
  for (const auto& [id, entity] : drawn)
    if (isCutAtAll(*entity) && !seen.contains(id)) forgotten.push_back(id);
  std::vector<std::string> faults;
  const auto add = [&](const std::vector<int>& ids, std::string_view what) {
    if (!ids.empty()) faults.push_back(fmt::format("{}: {}", namesOf(ids), what));
  };
  add(unknown, "not in the drawing");
  add(idle, "not cut: ignored, or left out by the selection");
  add(twice, "named more than once");
  add(forgotten, "not named, but to be cut");
  return faults;
}

std::vector<std::string> orderDoubts(const dieline::Dieline& dieline, const std::vector<int>& order) {
  const std::map<int, std::size_t> places = placesOf(order);
  std::vector<std::string> doubts;
  for (const dieline::Outline& outline : dieline::outlinesOf(dieline, dieline::Process::kCut).closed) {
    std::size_t done = 0;
    bool is_whole = true;
    std::set<int> edge;
    for (const dieline::OutlineStep& step : outline.steps) {
      const auto place = places.find(step.entity);
      is_whole = is_whole && place != places.end();
      if (is_whole) done = std::max(done, place->second);
      edge.insert(step.entity);
    }
    if (!is_whole) continue;
    std::vector<int> late;
    for (const dieline::Entity& entity : dieline.entities) {
      const auto place = places.find(entity.id);
      if (place == places.end() || place->second < done || edge.contains(entity.id)) continue;
      const Eigen::Vector2d p_mm = dieline::pointAt(entity.curve, 0.5);
      if (outline.box_mm.contains(p_mm) && dieline::contains(outline.polygon_mm, p_mm))
        late.push_back(entity.id);
    }
    if (late.empty()) continue;
    doubts.push_back(
        fmt::format("{} within the outline of E{}, which is cut through before: the piece may have moved",
                    namesOf(late), order[done]));
    if (doubts.size() == kMostDoubts) break;
  }
  return doubts;
}

std::vector<Stop> handOrder(const dieline::Dieline& dieline, const JobParameters& job,
                            const PlannerFaults& faults, Senses senses) {
  std::map<int, std::vector<Stop>> stops = stopsByEntity(dieline, job, faults);
  std::vector<Stop> order;
  for (const int id : job.given_order) std::ranges::move(stops[id], std::back_inserter(order));
  return senses == Senses::kDrawn ? order : withNearestStarts(std::move(order));
}

}  // namespace kerfbench::planner
