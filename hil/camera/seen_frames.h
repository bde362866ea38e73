// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "hil/camera/frame_source.h"

namespace kerfbench::camera {

/// Is shown each frame that somebody measures, in order, by the thread that takes it.
using FrameSeen = std::function<void(const Frame&)>;

/// Hands on the frames of another source, which somebody is shown on their way.
class SeenFrames final : public FrameSource {
 public:
  SeenFrames(std::unique_ptr<FrameSource> source, FrameSeen seen)
      : source_(std::move(source)), seen_(std::move(seen)) {}
  std::vector<Frame> nextBatch(std::size_t max) override { return shown(source_->nextBatch(max)); }
  std::vector<Frame> nextWindowed(std::size_t max, const WindowsFor& windows) override {
    return shown(source_->nextWindowed(max, windows));
  }

 private:
  std::vector<Frame> shown(std::vector<Frame> frames) const {
    for (const Frame& frame : frames) seen_(frame);
    return frames;
  }
  std::unique_ptr<FrameSource> source_;
  FrameSeen seen_;
};

/// The same while the machine runs.
class SeenFramesMeanwhile final : public FramesMeanwhile {
 public:
  SeenFramesMeanwhile(std::unique_ptr<FramesMeanwhile> source, FrameSeen seen)
      : source_(std::move(source)), seen_(std::move(seen)) {}
  std::vector<Frame> nextBatch(std::size_t max) override { return shown(source_->nextBatch(max)); }
  std::vector<Frame> nextWindowed(std::size_t max, const WindowsFor& windows) override {
    return shown(source_->nextWindowed(max, windows));
  }
  void want(double from_s, double to_s) override { source_->want(from_s, to_s); }
  void end() override { source_->end(); }
  void close() override { source_->close(); }

 private:
  std::vector<Frame> shown(std::vector<Frame> frames) const {
    for (const Frame& frame : frames) seen_(frame);
    return frames;
  }
  std::unique_ptr<FramesMeanwhile> source_;
  FrameSeen seen_;
};

}  // namespace kerfbench::camera
