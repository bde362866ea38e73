// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/twin_frames.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "hil/base/parallel.h"
#include "twin/base/image.h"

namespace kerfbench::camera {

TwinFrameSource::TwinFrameSource(twin::SpotCamera camera, std::vector<twin::Exposure> exposures, int threads)
    : camera_(std::move(camera)), exposures_(std::move(exposures)), threads_(threads) {
  const auto notAfter = [](const twin::Exposure& a, const twin::Exposure& b) {
    return a.sequence >= b.sequence;
  };
  if (std::adjacent_find(exposures_.begin(), exposures_.end(), notAfter) != exposures_.end()) {
    throw std::invalid_argument("TwinFrameSource: exposures out of order");
  }
  std::erase_if(exposures_,
                [this](const twin::Exposure& exposure) { return camera_.fateOf(exposure.sequence).dropped; });
}

std::vector<Frame> TwinFrameSource::nextBatch(std::size_t max) {
  const std::size_t count = std::min(max, exposures_.size() - next_);
  std::vector<Frame> frames(count);
  base::forEachIndex(count, threads_, [&](std::size_t i) {
    const twin::Exposure& exposure = exposures_[next_ + i];
    frames[i] = camera_.render(exposure);
    frames[i].start_s += camera_.fateOf(exposure.sequence).stamp_error_s;
  });
  next_ += count;
  return frames;
}

}  // namespace kerfbench::camera
