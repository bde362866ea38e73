// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf_plan.h"

namespace kerfbench::hil {

/// What the pixels' noise alone makes of each caliper's offset, by entity and station; NaN where none.
using PixelNoise = std::vector<std::vector<double>>;

/// Sets sigma_mm and width_sigma_mm of all calipers of one unit.
///
/// The scatter of the readings along a cut tells: noise of the pixels, texture of the board, roughness of the
/// edges. Third differences of readings 0.35 mm and more apart, which share no pixel, hold it (variance 20
/// sigma²) and hold next to nothing of a kerf that bends off slowly: of a wave of 20 um amplitude and 10 mm
/// length 0.05 um. They are pooled over some 12 mm along the curve, with a few degrees of belief in what all
/// cuts of the same process show, and steps (a fault is one) are clipped at 3 sigma. What the scatter shows
/// beyond the pixels' noise is added to each caliper's own share of that.
void setSigmas(const KerfPlan& plan, const PixelNoise& noise, std::vector<EntityKerf>& kerfs);

}  // namespace kerfbench::hil
