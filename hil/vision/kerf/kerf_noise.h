// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf/kerf_plan.h"

namespace kerfbench::vision {

/// Known errors of one entity's offsets beyond their scatter, by station.
struct CutNoise {
  std::vector<double> pixels_mm;  ///< Error by the pixels' noise alone; NaN where nothing was found.
  std::vector<double> board_mm;   ///< KerfReading::board_mm.
  std::vector<double> grid_mm;    ///< Error that the grid of pixels leaves.
  std::vector<double> model_mm;   ///< Error that the model of the flanks leaves.
};

/// Error that the grid of pixels leaves in a caliper's offset, px: the light between the pixels is not seen,
/// and a line along the grid meets the same gaps at all of its pixels. Along a window that crosses rows the
/// gaps cancel. The size was measured: tests/hil/vision/kerf_uncertainty_test.cpp.
double gridNoisePx(const Eigen::Vector2d& window_along_px);

/// Sets sigma_mm, steady_sigma_mm and width_sigma_mm of all calipers of one unit.
///
/// The scatter of the readings along a cut tells: noise of the pixels, texture of the board, roughness of the
/// edges. Third differences of readings 0.35 mm and more apart, which share no pixel, hold it (variance 20
/// sigma²) and hold next to nothing of a kerf that bends off slowly: of a wave of 20 um amplitude and 10 mm
/// length 0.05 um. They are pooled over some 12 mm along the curve, with a few degrees of belief in what all
/// cuts of the same process show, and steps (a fault is one) are clipped at 3 sigma.
///
/// A kerf that winds from millimetre to millimetre, as that of a beam does that follows the steps of its
/// mirrors, scatters too, and that is no noise. But it is smooth over the beam's own width, and noise is not:
/// no more is taken for noise than neighbouring readings, and the plain board next to the kerf, bear out.
///
/// What the scatter shows beyond the pixels' noise is added to each caliper's own share of that; so is what
/// is the same over long stretches, where no scatter tells: grid and model (steady_sigma_mm).
void setSigmas(const KerfPlan& plan, const std::vector<CutNoise>& noise, std::vector<EntityKerf>& kerfs);

}  // namespace kerfbench::vision
