// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hil/camera/frame_source.h"
#include "twin/camera/camera.h"

namespace kerfbench::camera {

/// Frames of the modelled spot camera, one per exposure, rendered on demand by several threads: those that
/// its link does not lose, with the time stamps that it gives them. The bytes are the same at any number of
/// threads and for any size of batch.
///
/// Frames of nextWindowed() take the time that the camera needs to read them out
/// (CameraDescription::read_out). If that is longer than a period, it is not exposed again before: the
/// exposures until then are no frames, and have no number in the sequence. Those of nextBatch() are whole and
/// take no time.
class TwinFrameSource final : public FrameSource {
 public:
  /// `exposures` in order of sequence; throws std::invalid_argument otherwise. A frame that is lost leaves a
  /// gap in the sequence, and is asked no windows for.
  TwinFrameSource(twin::SpotCamera camera, std::vector<twin::Exposure> exposures, int threads);

  std::vector<Frame> nextBatch(std::size_t max) override;
  std::vector<Frame> nextWindowed(std::size_t max, const WindowsFor& windows) override;

 private:
  twin::SpotCamera camera_;
  std::vector<twin::Exposure> exposures_;
  int threads_;
  std::size_t next_{0};
  std::uint64_t missed_{0};  ///< Exposures for which the camera was still reading out.
};

}  // namespace kerfbench::camera
