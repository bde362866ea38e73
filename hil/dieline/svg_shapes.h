// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hil/dieline/geometry.h"

namespace pugi {
class xml_node;
}  // namespace pugi

namespace kerfbench::dieline {

struct SvgShape {
  std::vector<Curve> curves;       ///< Lengths in user units.
  std::vector<std::string> parts;  ///< "" or "command 3", one per curve.
  std::vector<std::string> faults;
};

/// True for path, rect, circle, ellipse, line, polyline and polygon.
bool isSvgShape(std::string_view element);
/// How the numbers of a shape are read.
struct SvgUnits {
  double closing_tolerance{};  ///< As for readSvgPath().
  double px_per_inch{96.0};
  Eigen::Vector2d viewport{Eigen::Vector2d::Zero()};  ///< What 100 % is, user units.
};
/// The curves of a shape, by its name without a prefix.
SvgShape readSvgShape(const pugi::xml_node& node, const SvgUnits& units);

}  // namespace kerfbench::dieline
