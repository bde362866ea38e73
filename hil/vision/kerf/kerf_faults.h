// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/vision/image/lens_blur.h"
#include "hil/vision/kerf/kerf_tiles.h"

namespace kerfbench::vision {

/// Standard deviation of the blur that the edge of a printed disc shows, px, as imaged: lens, pixel and the
/// print's own raggedness. Of an edge blurred by a normal distribution, darkness D integrates to
///
///     integral of D (1 - D) across it = sigma / sqrt(pi),
///
/// whatever its exact place; noise adds to D (1 - D) its own variance with a minus, which is given back.
/// NaN where the disc is not whole in the picture.
double edgeBlurPx(const GrayImage& image, const CameraCalibration& calibration, const FoundMark& mark,
                  double noise_gray);

/// Blur of the pictures of a unit: the median of its marks. Its uncertainty is that of their scatter, and of
/// what the edge of the print itself is not sharp; kUsualBlur where no mark tells.
LensBlur blurOf(const std::vector<TileView>& tiles, const CameraCalibration& calibration);

/// Tiles of a unit that must not be measured in, as sentences: dark, saturated, without any noise; and all of
/// them, where they are blurred by more than widest_blur_px.
void tellTileFaults(const std::vector<TileView>& tiles, int unit, const LensBlur& blur, double widest_blur_px,
                    std::vector<std::string>& problems);

}  // namespace kerfbench::vision
