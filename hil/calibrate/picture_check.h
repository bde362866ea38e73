// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "twin/base/image.h"

namespace kerfbench::hil {

/// Why a picture is no good for measuring a target in it: empty, dark, saturated, blurred; "" for a good one.
std::string pictureFault(const GrayImage& image);

}  // namespace kerfbench::hil
