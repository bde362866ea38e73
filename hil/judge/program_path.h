// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::judge {

/// The program of one unit, as G-code: its pieces with the laser on, each from one opening of the gate to its
/// closing.
class ProgramPath {
 public:
  struct Piece {
    std::vector<planner::Segment> segments;
    double length_mm{};
    /// Energy for each mm over that of a cut: the mean Z.
    double z{};
    [[nodiscard]] int firstEntity() const { return segments.front().entity; }
    [[nodiscard]] bool has(int entity) const;
  };
  /// Without pieces if the text is none that the planner reads.
  explicit ProgramPath(const std::string& gcode);

  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
  [[nodiscard]] bool empty() const { return pieces_.empty(); }
  [[nodiscard]] bool has(int entity) const;
  [[nodiscard]] bool isNamed() const;  ///< True if it says which entities it cuts.
  /// All ways along an entity together.
  [[nodiscard]] double lengthOf(int entity) const;
  /// Offset of the program of an entity from a place of the drawing along a normal, S; NaN if the normal does
  /// not meet it within reach_mm.
  [[nodiscard]] double offsetAt(int entity, const Eigen::Vector2d& p_S_mm, const Eigen::Vector2d& normal,
                                double reach_mm) const;

 private:
  std::vector<Piece> pieces_;
};

/// Offset of a way from a place along a normal: where the way crosses the normal's line nearest to it.
class Crossing {
 public:
  Crossing(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& normal, double reach_mm)
      : p_mm_(p_mm), normal_(normal), reach_mm_(reach_mm) {}

  /// A straight piece of the way, in its order. True if it is the nearest crossing so far.
  bool take(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);
  [[nodiscard]] double offset_mm() const { return offset_mm_; }  ///< NaN: none.
  [[nodiscard]] double share() const { return share_; }          ///< Share of the piece at which it crosses.

 private:
  Eigen::Vector2d p_mm_, normal_;
  double reach_mm_;
  double offset_mm_{std::numeric_limits<double>::quiet_NaN()};
  double share_{};
};

}  // namespace kerfbench::judge
