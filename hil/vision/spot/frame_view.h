// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>

#include <Eigen/Core>

#include "twin/base/image.h"

namespace kerfbench::vision {

/// What a frame shows: the whole picture, or windows of it. Valid as long as the frame.
class FrameView {
 public:
  explicit FrameView(const Frame& frame)
      : parts_(frame.windows.empty() ? std::span(&frame.image, 1) : std::span(frame.windows)),
        whole_(frame.windows.empty()) {}
  /// A picture by itself.
  explicit FrameView(const GrayImage& whole) : parts_(&whole, 1), whole_(true) {}

  [[nodiscard]] bool whole() const { return whole_; }
  [[nodiscard]] std::span<const GrayImage> parts() const { return parts_; }
  /// The part that shows most around a pixel, to every side; null if none has it.
  [[nodiscard]] const GrayImage* around(const Eigen::Vector2d& pixel) const {
    const GrayImage* best = nullptr;
    double farthest = -0.5;
    for (const GrayImage& part : parts_) {
      if (part.pixels.empty()) continue;
      const double to_edge = std::min(std::min(pixel.x() - part.left, part.right() - pixel.x()),
                                      std::min(pixel.y() - part.top, part.bottom() - pixel.y()));
      if (to_edge <= farthest) continue;
      farthest = to_edge;
      best = &part;
    }
    return best;
  }

 private:
  std::span<const GrayImage> parts_;
  bool whole_;
};

}  // namespace kerfbench::vision
