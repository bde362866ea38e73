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
/// The curves of a shape. `closing_tolerance` as for readSvgPath().
SvgShape readSvgShape(const pugi::xml_node& node, double closing_tolerance);

}  // namespace kerfbench::dieline
