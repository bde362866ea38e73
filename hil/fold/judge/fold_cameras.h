// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "hil/camera/tile_source.h"
#include "twin/base/image.h"

namespace kerfbench::fold {

/// Cameras that look at a folded blank. The judge does not know whether a model or a machine stands behind
/// them.
class FoldCameras {
 public:
  virtual ~FoldCameras() = default;
  /// A picture of the blank as it stood when it was cut, by each survey camera; an empty one where it failed.
  virtual std::vector<GrayImage> surveyPictures() = 0;
  /// Pictures of the kerf camera of one face, unit 0, which lies flat on the back-lit table. Valid as long as
  /// this.
  virtual std::unique_ptr<camera::TileSource> kerfTiles(std::size_t face) = 0;
};

}  // namespace kerfbench::fold
