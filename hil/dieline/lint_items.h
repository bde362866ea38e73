// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {

constexpr double kZero_mm = 1e-3;     // Shorter is a dot.
constexpr double kMet_mm = 1e-3;      // Ends closer than this meet.
constexpr double kGap_mm = 0.5;       // Ends farther apart than this do not belong together.
constexpr double kOverlap_mm = 0.01;  // Shared length from which a line is cut twice.
constexpr double kSame_mm = 0.005;    // Curves closer than this lie on each other.

/// An entity with what the checks ask again and again.
struct LintItem {
  const Entity* entity{};
  Eigen::AlignedBox2d box;
  double length_mm{};
  std::array<Eigen::Vector2d, 5> samples;  ///< At equal arc lengths, both ends included.
  bool is_zero{};
  bool is_closed{};
  [[nodiscard]] bool isCut() const { return entity->process == Process::kCut; }
};

/// Items of all entities that are not ignored.
std::vector<LintItem> lintItems(const Dieline& dieline);

/// Boxes of items in a tree: whoever looks for those near a place asks few of them.
class LintBoxes {
 public:
  LintBoxes() = default;
  explicit LintBoxes(const std::vector<LintItem>& items);
  /// Visits items whose boxes touch `box`, and maybe others beside them, in no order, until a visit says
  /// true; true if one does.
  template <class Visit>
  bool any(const Eigen::AlignedBox2d& box, Visit visit) const {
    struct Near {
      const Eigen::AlignedBox2d& box;
      Visit& visit;
      bool found{false};
      bool intersectVolume(const Eigen::AlignedBox2d& volume) const { return box.intersects(volume); }
      bool intersectObject(std::size_t item) { return found = visit(item); }
    };
    Near near{box, visit};
    Eigen::BVIntersect(tree_, near);
    return near.found;
  }

 private:
  Eigen::KdBVH<double, 2, std::size_t> tree_;
};

/// One end of an item: sample 0 or 4.
struct LintEnd {
  std::uint32_t item{};
  std::uint32_t sample{};
};

/// End points in square cells, so that all ends within a side of a point are in 9 cells.
class LintEndGrid {
 public:
  LintEndGrid(const std::vector<LintItem>& items, double side_mm);
  /// Visits the ends of the 9 cells around a point, each cell until a visit says true.
  template <class Visit>
  void near(const Eigen::Vector2d& p_mm, Visit visit) const {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto cell = first_.find(key(p_mm, dx, dy));
        if (cell == first_.end()) continue;
        for (std::uint32_t at = cell->second; at < ends_.size() && ends_[at].first == cell->first; ++at) {
          if (visit(ends_[at].second)) break;
        }
      }
    }
  }

 private:
  [[nodiscard]] std::uint64_t key(const Eigen::Vector2d& p_mm, int dx, int dy) const;
  double side_mm_;
  std::vector<std::pair<std::uint64_t, LintEnd>> ends_;  ///< Sorted by cell; cuts first within one.
  std::unordered_map<std::uint64_t, std::uint32_t> first_;
};

/// Length on which two lines, or two arcs, lie on each other; 0 for other pairs.
double lintSharedLength(const LintItem& a, const LintItem& b);
/// True where two curves are one and the same within kSame_mm, whatever their sense or beginning.
bool lintSame(const LintItem& a, const LintItem& b);

/// A finding before it is put into words.
struct LintRaw {
  LintFinding::Kind kind{};
  bool is_error{};
  bool may_be_accepted{};
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  std::uint32_t item{};
  std::uint32_t other{};  ///< The second item, or the number of loose ends of an outline.
  double size_mm{};       ///< The length that is wrong.
  std::size_t number{};   ///< Order in which it was found.
};

/// Counts findings and keeps the worst of each kind.
class LintStore {
 public:
  LintStore(const std::vector<LintItem>& items, std::size_t most) : items_(items), most_(most) {}
  void add(LintRaw raw);
  /// A finding that is already in words.
  void add(LintFinding finding);
  [[nodiscard]] LintReport report() &&;

 private:
  [[nodiscard]] LintFinding inWords(const LintRaw& raw) const;
  const std::vector<LintItem>& items_;
  std::size_t most_;
  std::map<LintFinding::Kind, std::vector<LintRaw>> kept_;  ///< Heaps, the least bad on top.
  std::vector<LintFinding> in_words_;
  std::map<LintFinding::Kind, LintReport::Counts> counts_;
  std::size_t number_{};
};

}  // namespace kerfbench::dieline
