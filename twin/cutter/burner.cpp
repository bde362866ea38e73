// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/burner.h"

namespace kerfbench::twin {

void Burner::close(const Footprint& to) {
  sheet_.burn(from_, to, energy_j_);
  const double path_mm = (to.p_SQ_mm - from_.p_SQ_mm).norm();
  const double fitting = kChord_mm * steps_ / std::max(path_mm, kChord_mm / kMostSteps);
  planned_ = std::clamp(static_cast<int>(fitting), 1, std::min(kMostSteps, 2 * planned_));
  energy_j_ = 0.0;
  steps_ = 0;
  open_ = false;
}

void Burner::drop() {
  energy_j_ = 0.0;
  steps_ = 0;
  planned_ = 1;
  open_ = false;
}

}  // namespace kerfbench::twin
