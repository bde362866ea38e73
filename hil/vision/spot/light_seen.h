// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Light of the glowing spot above the board, all of it, in grey levels times pixels; 0 where none is seen
/// but the print. A quick look: trackSpot() finds some that this does not, on marks and where the board is
/// grainy. Of a spot that saturates it is a guess.
double spotLight(const GrayImage& image);

}  // namespace kerfbench::vision
