// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "twin/base/image_fwd.h"

namespace kerfbench::calibrate {

/// Standard deviation beyond which a picture is too blurred for its corners to be placed.
inline constexpr double kMostBlur_px = 2.5;

/// Reason why no target can be measured in a picture: empty, dark, saturated, blurred; "" for a good one.
std::string pictureFault(const GrayImage& image);

}  // namespace kerfbench::calibrate
