// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/repeats.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/lint_items.h"

namespace kerfbench::dieline {
namespace {

/// Pairs that are looked at, for each line: what has more is no drawing but a heap of lines on each other.
constexpr std::size_t kMostPairsOfOne = 1000;

bool liesOn(const LintItem& item, const LintItem& other) {
  return lintSame(other, item) || lintSharedLength(other, item) >= item.length_mm - kOverlap_mm;
}

/// The longest first, and of those that are alike the first of the file.
std::vector<std::size_t> longestFirst(const std::vector<LintItem>& items) {
  std::vector<std::size_t> order(items.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  // What lintSame() takes for one length is one here as well.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::round(items[a].length_mm / kOverlap_mm) > std::round(items[b].length_mm / kOverlap_mm);
  });
  return order;
}

}  // namespace

void leaveOutRepeats(Dieline& dieline, FaultList& faults) {
  const std::vector<LintItem> items = lintItems(dieline);
  if (items.empty()) return;
  const LintBoxes boxes(items);
  std::vector<bool> stays(items.size(), false);
  std::vector<bool> left_out(dieline.entities.size(), false);
  std::size_t count = 0;
  double length_mm = 0.0;
  std::size_t pairs = 0;
  for (const std::size_t i : longestFirst(items)) {
    const LintItem& item = items[i];
    const bool repeats = !item.is_zero && boxes.any(item.box, [&](std::size_t other) {
      ++pairs;
      return stays[other] && items[other].entity->process == item.entity->process &&
             liesOn(item, items[other]);
    });
    stays[i] = !repeats && !item.is_zero;
    if (pairs > kMostPairsOfOne * (items.size() + kMostPairsOfOne)) {
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
