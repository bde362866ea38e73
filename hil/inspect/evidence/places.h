// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <Eigen/Core>

namespace kerfbench::inspect::checks {

/// "unit 2, E14"
std::string nameOf(int unit, int entity);
/// "x 12.30, y 45.60 mm"; never "-0.00".
std::string placeOf(const Eigen::Vector2d& p_S_mm);
/// "right" or "left" of the line, seen in the sense of the curve, for a signed offset.
std::string_view sideOf(double offset_mm);

}  // namespace kerfbench::inspect::checks
