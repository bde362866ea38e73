// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kerfbench::dieline {

/// An item as a place in four dimensions, mm: the ends of a line (x0, y0, x1, y1), the corners of a box, or
/// the centre and the radius of an arc. Long lines that cross are far from each other there, those that lie
/// on each other are near.
using LintPlace = std::array<double, 4>;

/// Box around places.
struct LintSpan {
  LintPlace low;
  LintPlace high;
};

/// Places in a tree that is built once: at each node the half of the places that lie lower along the longest
/// side of their box, then the other half. Nodes are in the order in which a search meets them, each with the
/// next one for those who do not enter.
class LintTree {
 public:
  struct Leaf {
    LintPlace place;
    std::uint32_t item{};
  };

  LintTree() = default;
  explicit LintTree(std::vector<Leaf> leaves);
  [[nodiscard]] bool empty() const { return leaves_.empty(); }

  /// Visits the leaves of all nodes whose span `enter` takes, until a visit says true; true if one does.
  template <class Enter, class Visit>
  bool any(Enter enter, Visit visit) const {
    for (std::size_t at = 0; at < nodes_.size();) {
      const Node& node = nodes_[at];
      if (!enter(node.span)) {
        at = node.next;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.end; ++i) {
        if (visit(leaves_[i])) return true;
      }
      ++at;
    }
    return false;
  }

 private:
  struct Node {
    LintSpan span;
    std::uint32_t next{};   ///< The node after all that are below this one.
    std::uint32_t first{};  ///< Leaves of a node with none below it.
    std::uint32_t end{};
  };
  void build(std::size_t first, std::size_t end);

  std::vector<Leaf> leaves_;
  std::vector<Node> nodes_;
};

}  // namespace kerfbench::dieline
