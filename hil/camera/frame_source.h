// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "twin/base/image_fwd.h"

namespace kerfbench::camera {

/// Source of frames: the twin's cameras, files, V4L2.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frames in order of sequence, at most `max`; empty at the end. May use several threads inside;
  /// the frames are the same at any number of them.
  virtual std::vector<Frame> nextBatch(std::size_t max) = 0;
};

}  // namespace kerfbench::camera
