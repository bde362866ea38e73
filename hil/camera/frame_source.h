// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "twin/base/image.h"

namespace kerfbench::camera {

/// The windows that a frame is to be read out by, for the begin of its exposure on the clock of the pins, in
/// s; none: the whole picture. Asked once for each frame, in order.
using WindowsFor = std::function<std::vector<PixelWindow>(double start_s)>;

/// Source of frames: the twin's cameras, files, V4L2.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frames in order of sequence, at most `max`; empty at the end. May use several threads inside;
  /// the frames are the same at any number of them.
  virtual std::vector<Frame> nextBatch(std::size_t max) = 0;
  /// The same, by windows where the camera can. A source that cannot hands out whole pictures.
  virtual std::vector<Frame> nextWindowed(std::size_t max, const WindowsFor& /*windows*/) {
    return nextBatch(max);
  }
};

/// Frames of a camera whose machine still runs: who runs it says which are wanted, on one thread, and who
/// measures takes them, on another.
class FramesMeanwhile : public FrameSource {
 public:
  /// Frames whose exposure began in [from_s, to_s], on the clock of the pins, are handed out as soon as they
  /// are taken; those before from_s are dropped, those after to_s wait to be wanted. Neither time may go
  /// back. Waits while too many that are wanted wait to be measured.
  virtual void want(double from_s, double to_s) = 0;
  /// The machine has stopped, and no more is wanted.
  virtual void end() = 0;
  /// Nobody measures any more: nothing waits from now on, for either.
  virtual void close() = 0;
};

}  // namespace kerfbench::camera
