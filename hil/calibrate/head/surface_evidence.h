// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hil/calibrate/head/joint_marks.h"
#include "hil/calibrate/head/joint_solver.h"
#include "hil/calibrate/head/residual_surface.h"

namespace kerfbench::calibrate {

/// Decays of 0.5 … 1 for which the marks may show a surface. The others are ruled out by a score test, which
/// costs less than their evidence.
std::vector<double> promisingDecays(const JointMarks& marks, const SmoothBasis& basis);

/// The prior with the largest marginal likelihood, of these decays and amplitudes of 0.1 µm … 10 mm; nullopt
/// where even that one has odds below 20 : 1 against no surface.
std::optional<SurfacePrior> bestSurface(const JointMarks& marks, const SmoothBasis& basis,
                                        std::span<const double> decays);

}  // namespace kerfbench::calibrate
