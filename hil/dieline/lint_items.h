// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

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
  std::uint32_t number{};  ///< Place in the drawing, among those that are not ignored.
  [[nodiscard]] bool isCut() const { return entity->process == Process::kCut; }
};

/// Items of all entities that are not ignored. Neighbours on the sheet are near each other in memory:
/// searches go from one to the next.
std::vector<LintItem> lintItems(const Dieline& dieline);

/// One end of an item: sample 0 or 4.
struct LintEnd {
  std::uint32_t item{};
  std::uint32_t sample{};
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
