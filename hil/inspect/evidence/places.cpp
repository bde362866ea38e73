// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/places.h"

#include <fmt/format.h>

#include "hil/base/text.h"

namespace kerfbench::inspect::checks {

std::string nameOf(int unit, int entity) { return fmt::format("unit {}, E{}", unit, entity); }
std::string placeOf(const Eigen::Vector2d& p_S_mm) {
  return fmt::format("x {}, y {} mm", base::hundredths(p_S_mm.x()), base::hundredths(p_S_mm.y()));
}
std::string_view sideOf(double offset_mm) { return offset_mm < 0.0 ? "right" : "left"; }

}  // namespace kerfbench::inspect::checks
