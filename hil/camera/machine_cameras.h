// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "hil/camera/frame_source.h"
#include "hil/camera/tile_source.h"

namespace kerfbench::camera {

/// Cameras of a run. The judge does not know whether a model or a machine stands behind them.
class MachineCameras {
 public:
  virtual ~MachineCameras() = default;
  /// Frames of the spot camera whose exposure began in [from_s, to_s] on the clock of the pins; each frame is
  /// handed out once. `threads` changes the time it takes, never the frames.
  virtual std::unique_ptr<FrameSource> spotFrames(double from_s, double to_s, int threads) = 0;
  /// The same frames while the machine runs; to be called before. Null: these cameras are asked afterwards.
  virtual std::unique_ptr<FramesMeanwhile> spotFramesMeanwhile(int /*threads*/) { return nullptr; }
  /// Pictures of the kerf camera of the sheet as it was in the end. Valid as long as this.
  virtual std::unique_ptr<TileSource> kerfTiles(int threads) = 0;
  /// The same pictures while the machine runs; to be called before. `most_waiting`: units that may wait for
  /// their pictures, >= 1; then the machine waits. Null: this camera is asked afterwards.
  virtual std::unique_ptr<TilesMeanwhile> kerfTilesMeanwhile(int /*threads*/, std::size_t /*most_waiting*/) {
    return nullptr;
  }
};

}  // namespace kerfbench::camera
