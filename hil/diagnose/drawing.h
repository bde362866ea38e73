// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/dieline/geometry.h"
#include "twin/base/print_layout.h"

namespace kerfbench::diagnose {

/// A curve of the drawing as straight lines, which lie within 0.01 mm of those of dieline drawings. mm, in S.
class Polyline {
 public:
  explicit Polyline(const dieline::Curve& curve);
  [[nodiscard]] const Eigen::AlignedBox2d& box() const { return box_; }

  /// Takes the way from the nearest point of the curve to p where it is shorter than `away`.
  void shorten(const Eigen::Vector2d& p_mm, Eigen::Vector2d& away) const;

 private:
  struct Line {
    Eigen::Vector2d start, along;
  };
  std::vector<Line> lines_;
  Eigen::AlignedBox2d box_;
};

/// All lines that are to be cut, creased or perforated. `print` must outlive it.
class Drawing {
 public:
  Drawing(const dieline::Dieline& dieline, const PrintLayout& print);
  [[nodiscard]] bool empty() const { return curves_.empty(); }
  [[nodiscard]] Eigen::Vector2d size_mm() const { return box_.sizes(); }

  /// A place on the web, from the origin of unit 0, as one of unit 0.
  [[nodiscard]] Eigen::Vector2d inUnit(Eigen::Vector2d p_mm) const;
  /// From the nearest point of the drawing to one of unit 0.
  [[nodiscard]] Eigen::Vector2d awayFrom(const Eigen::Vector2d& p_mm) const;

 private:
  const PrintLayout& print_;
  std::vector<Polyline> curves_;
  Eigen::AlignedBox2d box_;
};

}  // namespace kerfbench::diagnose
