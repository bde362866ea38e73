// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/places.h"

#include <cmath>

#include <fmt/format.h>

namespace kerfbench::inspect::checks {

std::string nameOf(int unit, int entity) { return fmt::format("unit {}, E{}", unit, entity); }
std::string placeOf(const Eigen::Vector2d& p_S_mm) {
  // A hundredth of a millimetre; what is rounded to zero has no sign.
  const auto shown = [](double mm) { return std::round(100.0 * mm) / 100.0 + 0.0; };
  return fmt::format("x {:.2f}, y {:.2f} mm", shown(p_S_mm.x()), shown(p_S_mm.y()));
}
std::string_view sideOf(double offset_mm) { return offset_mm < 0.0 ? "right" : "left"; }

}  // namespace kerfbench::inspect::checks
