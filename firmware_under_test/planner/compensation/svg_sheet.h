// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// An SVG drawing in mm, y upwards. Styles are CSS, widths in mm.
class SvgSheet {
 public:
  explicit SvgSheet(const Eigen::AlignedBox2d& box_mm, double px_per_mm);
  void path(const std::vector<Segment>& segments, const std::string& style);
  void polyline(const std::vector<Eigen::Vector2d>& points, const std::string& style);
  void ellipse(const Eigen::Vector2d& centre_mm, double rx_mm, double ry_mm, const std::string& style);
  void text(const Eigen::Vector2d& p_mm, double height_mm, const std::string& words);
  [[nodiscard]] std::string finish() const;

 private:
  std::string head_;
  std::string shapes_;
  std::string words_;
};

/// Picture of contours in black, beam paths in red, and what they burn.
std::string kerfPicture(const std::vector<std::vector<Segment>>& contours,
                        const std::vector<std::vector<Segment>>& paths, double radius_mm);

}  // namespace kerfbench::planner
