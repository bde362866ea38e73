// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/lint_tree.h"

#include <algorithm>
#include <utility>

namespace kerfbench::dieline {
namespace {
constexpr std::size_t kMostOfANode = 6;  // Fewer make more nodes, more make more visits in vain.
}

LintTree::LintTree(std::vector<Leaf> leaves) : leaves_(std::move(leaves)) {
  if (leaves_.empty()) return;
  nodes_.reserve(4 * leaves_.size() / kMostOfANode + 1);
  build(0, leaves_.size());
}

void LintTree::build(std::size_t first, std::size_t end) {
  const std::size_t here = nodes_.size();
  LintSpan span{leaves_[first].place, leaves_[first].place};
  for (std::size_t i = first + 1; i < end; ++i) {
    for (std::size_t k = 0; k < span.low.size(); ++k) {
      span.low[k] = std::min(span.low[k], leaves_[i].place[k]);
      span.high[k] = std::max(span.high[k], leaves_[i].place[k]);
    }
  }
  nodes_.push_back({span, 0, 0, 0});
  if (end - first <= kMostOfANode) {
    nodes_[here].first = static_cast<std::uint32_t>(first);
    nodes_[here].end = static_cast<std::uint32_t>(end);
  } else {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < span.low.size(); ++k) {
      if (span.high[k] - span.low[k] > span.high[axis] - span.low[axis]) axis = k;
    }
    const std::size_t middle = first + (end - first) / 2;
    const auto begin = leaves_.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(end),
                     [axis](const Leaf& a, const Leaf& b) { return a.place[axis] < b.place[axis]; });
    build(first, middle);
    build(middle, end);
  }
  nodes_[here].next = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace kerfbench::dieline
