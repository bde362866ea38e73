// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/diagnose/diagnosis.h"

namespace kerfbench::diagnose {

/// Finds, among the causes that move lines, those that explain the deviation best, at most two. Score: gain
/// in chi square over what the machine's tolerances explain, less ln n for each size that was found (Schwarz
/// 1978), with chi square scaled to what all causes together leave.
struct Fitted {
  std::vector<Cause> causes;
  double deviation_mm{kUnknown};
  /// Mean square of the deviation that arises in program, controller and machine.
  std::vector<double> stage_mm2{0.0, 0.0, 0.0};
};
Fitted fittedCauses(const Evidence& evidence);

}  // namespace kerfbench::diagnose
