// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// A curve of a path and the number of its command, counted from 1.
struct SvgPathCurve {
  Curve curve;
  std::size_t command{};
};

struct SvgPath {
  std::vector<SvgPathCurve> curves;
  std::string fault;  ///< Empty when the whole of the data is sound.
};

/// Reads path data (SVG 1.1, 8.3), exactly: quadratic curves are raised to cubic ones, elliptic arcs stay
/// ellipses. `closing_tolerance` in user units: a Z that spans less draws no line, for it is the rounding of
/// the file's decimals.
SvgPath readSvgPath(std::string_view data, double closing_tolerance);

/// An elliptic arc as SVG writes it, but for its ends.
struct SvgArc {
  double rx, ry;    ///< Radii, user units.
  double tilt_rad;  ///< Angle from x to the first radius.
  bool large;       ///< The longer of two arcs.
  bool positive;    ///< The angle grows along the arc.
};

/// The arc between two points as SVG gives it (appendix F.6): radii grow where they are too small.
Curve svgArc(const Eigen::Vector2d& from, const SvgArc& arc, const Eigen::Vector2d& to);

}  // namespace kerfbench::dieline
