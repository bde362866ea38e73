// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// Distance of ends that count as touching, mm, as the kerf scan has it.
inline constexpr double kEndsMeet_mm = 0.02;

/// A curve of an outline, and whether it is walked in its own sense.
struct OutlineStep {
  int entity{};
  bool forward{};
};

/// Curves of which each begins where the last ended.
struct Outline {
  std::vector<OutlineStep> steps;
  std::vector<Eigen::Vector2d> polygon_mm;  ///< Places along a closed one, no more than 0.5 mm apart.
  Eigen::AlignedBox2d box_mm;               ///< Box around the polygon.
};

/// An end of a curve at which two others or more begin or end.
struct Branching {
  int entity{};
  int others{};
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
};

/// Outlines of a drawing. An open one has the sense of its first curve.
struct Outlines {
  std::vector<Outline> closed;
  std::vector<std::vector<OutlineStep>> open;
  std::vector<Branching> branchings;
};

/// Joins all that was drawn for `process`, selected or not, where ends meet (kEndsMeet_mm). At a branching no
/// curves are joined.
Outlines outlinesOf(const Dieline& dieline, Process process);

/// True where p_mm is inside of a closed polygon (even-odd).
bool contains(const std::vector<Eigen::Vector2d>& polygon_mm, const Eigen::Vector2d& p_mm);
/// For each closed outline the number of others around it: 0 for an outer edge, odd for a hole, even for a
/// piece within a hole.
std::vector<int> nestingsOf(const Outlines& outlines);

}  // namespace kerfbench::dieline
