// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/repeats.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/lint_items.h"
#include "hil/dieline/lint_near.h"

namespace kerfbench::dieline {
namespace {

/// Steps of the search and comparisons, as many as lint may take: what needs more is no drawing but a heap of
/// lines on each other.
constexpr std::size_t kMostSteps = 300'000'000;
constexpr std::size_t kMostStepsOfOne = 500;

bool liesOn(const LintItem& item, const LintItem& other) {
  return lintSame(other, item) || lintSharedLength(other, item) >= item.length_mm - kOverlap_mm;
}

/// The longest first, and of those that are alike the first of the file.
std::vector<std::uint32_t> longestFirst(const std::vector<LintItem>& items) {
  std::vector<std::uint32_t> order(items.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  // What lintSame() takes for one length is one here as well.
  const auto key = [&](std::uint32_t i) {
    return std::pair(-std::round(items[i].length_mm / kOverlap_mm), items[i].number);
  };
  std::ranges::sort(order, {}, key);
  return order;
}

}  // namespace

void leaveOutRepeats(Dieline& dieline, FaultList& faults) {
  const std::vector<LintItem> items = lintItems(dieline);
  if (items.empty()) return;
  LintBudget budget{kMostSteps + kMostStepsOfOne * items.size()};
  LintNear near(items, budget);
  std::vector<bool> stays(items.size(), false);
  std::vector<bool> left_out(dieline.entities.size(), false);
  std::size_t count = 0;
  double length_mm = 0.0;
  std::vector<std::uint32_t> candidates;
  for (const std::uint32_t i : longestFirst(items)) {
    const LintItem& item = items[i];
    candidates.clear();
    if (!item.is_zero) near.like(i, items.size(), candidates);
    const bool repeats = std::ranges::any_of(candidates, [&](std::uint32_t other) {
      return budget.take() && stays[other] && items[other].entity->process == item.entity->process &&
             liesOn(item, items[other]);
    });
    stays[i] = !repeats && !item.is_zero;
    if (budget.isSpent()) {
      faults.add(
          0, "so many lines are near each other that not all were compared: are there copies on each other?");
      return;
    }
    if (!repeats) continue;
    left_out[static_cast<std::size_t>(item.entity - dieline.entities.data())] = true;
    length_mm += item.length_mm;
    ++count;
  }
  if (count == 0) return;
  std::vector<Entity> others;
  others.reserve(dieline.entities.size() - count);
  std::string first;
  for (std::size_t i = 0; i < dieline.entities.size(); ++i) {
    if (left_out[i]) {
      if (first.empty()) first = dieline.entities[i].origin;
      continue;
    }
    others.push_back(std::move(dieline.entities[i]));
    others.back().id = static_cast<int>(others.size()) - 1;
  }
  dieline.entities = std::move(others);
  dieline.notes.push_back(
      fmt::format("repeated lines: {} of {:.3f} mm left out: each line is cut once (the first: {})", count,
                  length_mm, first));
}

}  // namespace kerfbench::dieline
