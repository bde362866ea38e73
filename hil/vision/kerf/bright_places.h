// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/kerf/kerf_tiles.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Mask of what is brighter than the board of its surroundings by this share of the way from board to open
/// kerf, by three sigma of a pixel, and by five of the board's own grain: 255 there, else 0. The mean of nine
/// pixels finds a cut that is thinner than a pixel, or not through.
GrayImage brightPlaces(const TileView& view, double open_gray, double least_share);

}  // namespace kerfbench::vision
