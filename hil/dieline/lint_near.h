// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/lint_items.h"
#include "hil/dieline/lint_tree.h"

namespace kerfbench::dieline {

inline bool isLintLine(const LintItem& item) { return std::holds_alternative<LineCurve>(item.entity->curve); }

/// Steps that a check may take.
struct LintBudget {
  std::size_t most{};
  std::size_t taken{};
  bool take() { return ++taken <= most; }
  [[nodiscard]] bool isSpent() const { return taken > most; }
};

/// Finds the items that may lie on each other or on a point, among all that are not of length zero. What
/// crosses is not found: a hatch of n lines has n^2 crossings, and nothing is wrong with them.
class LintNear {
 public:
  /// Each node and each item that is looked at is taken from the budget; a search that it does not suffice
  /// for ends with what it has.
  LintNear(const std::vector<LintItem>& items, LintBudget& budget);

  /// Ends of others that lie within kSame_mm of a line, and a few more. False, and nothing of use, where they
  /// are more than `most`: that takes like() and through() for this line.
  bool onLine(std::uint32_t item, std::size_t most, std::vector<LintEnd>& found);

  /// True if two lines of which an end of one lies on the other may share a length above kOverlap_mm or be
  /// the same.
  [[nodiscard]] bool mayShare(std::uint32_t a, std::uint32_t b) const;

  /// Items that can be the same as `item` (lintSame) or share a length above kOverlap_mm with it
  /// (lintSharedLength), and a few others; each once, the item itself not, in the order of the drawing.
  /// False, and nothing of use, where they are more than `most`.
  bool like(std::uint32_t item, std::size_t most, std::vector<std::uint32_t>& found);

  /// Visits ends of cuts, or of all others, within `r_mm` of a point, until a visit says true; true if one
  /// does. The same ends come in the same order from wherever they are looked for. `r_mm` may shrink
  /// meanwhile.
  template <class Visit>
  bool ends(bool of_cuts, const Eigen::Vector2d& p_mm, const double& r_mm, Visit visit) {
    const LintTree& tree = of_cuts ? ends_of_cuts_ : other_ends_;
    const auto isNear = [&](const LintSpan& span) {
      return p_mm.x() >= span.low[0] - r_mm && p_mm.x() <= span.high[0] + r_mm &&
             p_mm.y() >= span.low[1] - r_mm && p_mm.y() <= span.high[1] + r_mm;
    };
    return tree.any([&](const LintSpan& span) { return budget_.take() && isNear(span); },
                    [&](const LintTree::Leaf& leaf) {
                      const double d_mm = (Eigen::Vector2d(leaf.place[0], leaf.place[1]) - p_mm).norm();
                      if (!budget_.take() || d_mm > r_mm) return false;
                      return visit(endOf(leaf), d_mm);
                    });
  }

  /// Visits curves that may pass within kMet_mm of a point, and lines if `of_lines`, until a visit says true;
  /// true if one does.
  template <class Visit>
  bool through(const Eigen::Vector2d& p_mm, bool of_lines, Visit visit) {
    const auto search = [&](const LintTree& tree, auto mayPass) {
      return tree.any(
          [&](const LintSpan& span) { return budget_.take() && mayPass(span, p_mm, kMet_mm); },
          [&](const LintTree::Leaf& leaf) {
            return budget_.take() && mayPass({leaf.place, leaf.place}, p_mm, kMet_mm) && visit(leaf.item);
          });
    };
    return (of_lines && search(lines(), passes)) || search(curves_, reaches);
  }

 private:
  struct Search;
  const LintTree& lines();
  bool likeCurve(const LintItem& self, std::size_t most, std::vector<std::uint32_t>& found);
  static LintEnd endOf(const LintTree::Leaf& leaf) { return {leaf.item / 2, leaf.item % 2 == 0 ? 0U : 4U}; }
  /// True if a line with its ends in these spans may pass within r of a point.
  static bool passes(const LintSpan& span, const Eigen::Vector2d& p_mm, double r_mm);
  /// True if a box with its corners in these spans may reach within r of a point.
  static bool reaches(const LintSpan& span, const Eigen::Vector2d& p_mm, double r_mm) {
    return p_mm.x() >= span.low[0] - r_mm && p_mm.y() >= span.low[1] - r_mm &&
           p_mm.x() <= span.high[2] + r_mm && p_mm.y() <= span.high[3] + r_mm;
  }
  bool at(const LintTree& tree, const LintPlace& place, double r_mm, std::size_t most,
          std::vector<std::uint32_t>& found);

  const std::vector<LintItem>& items_;
  LintBudget& budget_;
  LintTree lines_;   ///< Ends of lines, the one with the lesser x first; made when first asked for.
  LintTree curves_;  ///< Corners of the boxes of all others.
  LintTree arcs_;    ///< Centres and radii of arcs.
  LintTree ends_of_cuts_,
      other_ends_;  ///< Ends of what is not closed; twice the item, and 1 more for the last sample.
};

}  // namespace kerfbench::dieline
