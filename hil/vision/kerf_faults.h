// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/vision/kerf_tiles.h"

namespace kerfbench::hil {

/// Standard deviation of the blur that the edge of a printed disc shows, px, as imaged: lens, pixel and the
/// print's own raggedness. Of an edge blurred by a normal distribution, darkness D integrates to
///
///     integral of D (1 - D) across it = sigma / sqrt(pi),
///
/// whatever its exact place; noise adds to D (1 - D) its own variance with a minus, which is given back.
/// NaN where the disc is not whole in the picture.
double edgeBlurPx(const GrayImage& image, const CameraCalibration& calibration, const FoundMark& mark,
                  double noise_gray);

/// Tiles of a unit that must not be measured in, as sentences: dark, saturated, without any noise; and all of
/// them, where the median of their marks is blurred by more than widest_blur_px.
void tellTileFaults(const std::vector<TileView>& tiles, const CameraCalibration& calibration, int unit,
                    double widest_blur_px, std::vector<std::string>& problems);

}  // namespace kerfbench::hil
