// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/twin_frames.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "hil/base/parallel.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

constexpr double kRounding =
    1e-6;  // Share of a period: one that is just as long as the read-out is long enough.

}  // namespace

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

std::vector<Frame> TwinFrameSource::nextBatch(std::size_t max) { return nextWindowed(max, nullptr); }

std::vector<Frame> TwinFrameSource::nextWindowed(std::size_t max, const WindowsFor& windows) {
  struct Order {
    const twin::Exposure* exposure{};
    std::uint64_t sequence{};
    std::vector<PixelWindow> windows;
  };
  const twin::CameraDescription& camera = camera_.description();
  const std::vector<PixelWindow> whole{{0, 0, camera.width_px, camera.height_px}};
  std::vector<Order> orders;
  while (orders.size() < max && next_ < exposures_.size()) {
    const twin::Exposure& exposure = exposures_[next_++];
    Order& order = orders.emplace_back(Order{&exposure, exposure.sequence - missed_, {}});
    if (windows) order.windows = windows(exposure.start_s);
    const double read_s =
        windows ? camera.read_out.time_s(order.windows.empty() ? whole : order.windows, camera.bits) : 0.0;
    const double periods = std::max(1.0, std::ceil(read_s / camera.frame_period_s - kRounding));
    const std::uint64_t ready = exposure.sequence + static_cast<std::uint64_t>(periods);
    while (next_ < exposures_.size() && exposures_[next_].sequence < ready) ++next_;
    missed_ += ready - exposure.sequence - 1;
  }
  std::vector<Frame> frames(orders.size());
  base::forEachIndex(orders.size(), threads_, [&](std::size_t i) {
    const Order& order = orders[i];
    frames[i] = order.windows.empty() ? camera_.render(*order.exposure)
                                      : camera_.render(*order.exposure, order.windows);
    frames[i].sequence = order.sequence;
    frames[i].start_s += camera_.fateOf(order.exposure->sequence).stamp_error_s;
  });
  return frames;
}

}  // namespace kerfbench::camera
