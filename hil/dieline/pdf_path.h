// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "hil/dieline/pdf_clip.h"

namespace kerfbench::dieline {

/// A path under construction (ISO 32000-1, 8.5.2), in mm in S.
class PdfPath {
 public:
  void moveTo(const Eigen::Vector2d& p_mm);
  /// These need a current point; false without one.
  bool lineTo(const Eigen::Vector2d& p_mm);
  bool curveTo(const Eigen::Vector2d& p1_mm, const Eigen::Vector2d& p2_mm, const Eigen::Vector2d& p_mm);
  bool close();
  void clear();

  [[nodiscard]] bool hasPoint() const { return has_point_; }
  [[nodiscard]] const Eigen::Vector2d& point() const { return point_mm_; }
  /// Lines and curves so far.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// The curves, without those of no length. A closed subpath ends where it began.
  /// `dots` counts subpaths that have no length at all.
  [[nodiscard]] std::vector<Curve> curves(std::size_t& dots) const;
  /// The path as a region: open subpaths are closed, curves are polygons to a micrometre or so.
  [[nodiscard]] PdfRegion region(bool is_even_odd) const;

 private:
  enum class Step : char { kMove, kLine, kCurve, kClose };

  std::vector<Step> steps_;
  std::vector<Eigen::Vector2d> points_mm_;
  Eigen::Vector2d start_mm_{Eigen::Vector2d::Zero()};
  Eigen::Vector2d point_mm_{Eigen::Vector2d::Zero()};
  bool has_point_{};
  std::size_t size_{};
};

}  // namespace kerfbench::dieline
