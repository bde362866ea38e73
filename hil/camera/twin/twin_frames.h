// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hil/camera/frame_source.h"
#include "hil/camera/twin/exposure_feed.h"
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
class TwinFrameSource final : public FramesMeanwhile {
 public:
  /// `exposures` in order of sequence; throws std::invalid_argument otherwise. A frame that is lost leaves a
  /// gap in the sequence, and is asked no windows for.
  TwinFrameSource(twin::SpotCamera camera, std::vector<twin::Exposure> exposures, int threads);
  /// Exposures of a machine that runs.
  TwinFrameSource(twin::SpotCamera camera, std::shared_ptr<ExposureFeed> feed, int threads);

  std::vector<Frame> nextBatch(std::size_t max) override;
  std::vector<Frame> nextWindowed(std::size_t max, const WindowsFor& windows) override;
  void want(double from_s, double to_s) override { feed_->want(from_s, to_s); }
  void end() override { feed_->end(); }
  void close() override { feed_->close(); }

 private:
  /// The next exposure that the camera takes: that its link does not lose, and for which it is ready.
  std::optional<twin::Exposure> next();

  twin::SpotCamera camera_;
  std::shared_ptr<ExposureFeed> feed_;
  int threads_;
  std::vector<twin::Exposure> taken_;  ///< From the feed, up to next_ already looked at.
  std::size_t next_{0};
  std::uint64_t ready_{0};   ///< Sequence from which the camera has read out the frame before.
  std::uint64_t missed_{0};  ///< Exposures for which the camera was still reading out.
};

}  // namespace kerfbench::camera
