// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/camera/tile_source.h"
#include "hil/vision/image/lens_blur.h"
#include "hil/vision/kerf/kerf_tiles.h"

namespace kerfbench::vision {

/// Hands out the tiles of one unit after the other.
class UnitTiles {
 public:
  UnitTiles(camera::TileSource& source, const CameraCalibration& calibration)
      : source_(source), calibration_(calibration) {}

  /// Empty at the end. @throws std::invalid_argument for a tile that has not the size that the camera is
  /// calibrated for.
  std::vector<camera::KerfTile> next();

 private:
  camera::TileSource& source_;
  const CameraCalibration& calibration_;
  std::vector<camera::KerfTile> pending_;  ///< Last one first.
};

/// The pictures of one unit, ready to be measured in.
struct UnitPictures {
  std::vector<TileView> views;
  LensBlur blur;
};

/// Looks at board, printed marks of `print`, light and blur; pictures that must not be measured in are named
/// in `problems`.
UnitPictures viewUnit(std::vector<camera::KerfTile> tiles, int unit, const PrintLayout& print,
                      const CameraCalibration& calibration, const KerfScanOptions& options,
                      std::vector<std::string>& problems);

}  // namespace kerfbench::vision
