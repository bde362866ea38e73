// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/twin_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hil/base/parallel.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

constexpr double kRounding =
    1e-6;  // Share of a period: one that is just as long as the read-out is long enough.

std::shared_ptr<ExposureFeed> fedWith(std::vector<twin::Exposure> exposures) {
  constexpr double kAlways_s = std::numeric_limits<double>::infinity();
  auto feed = std::make_shared<ExposureFeed>(exposures.size());
  feed->add(std::move(exposures));
  feed->want(-kAlways_s, kAlways_s);
  feed->end();
  return feed;
}

}  // namespace

TwinFrameSource::TwinFrameSource(twin::SpotCamera camera, std::vector<twin::Exposure> exposures, int threads)
    : TwinFrameSource(std::move(camera), fedWith(std::move(exposures)), threads) {}

TwinFrameSource::TwinFrameSource(twin::SpotCamera camera, std::shared_ptr<ExposureFeed> feed, int threads)
    : camera_(std::move(camera)), feed_(std::move(feed)), threads_(threads) {}

std::optional<twin::Exposure> TwinFrameSource::next() {
  for (;;) {
    while (next_ < taken_.size()) {
      twin::Exposure& exposure = taken_[next_++];
      if (!camera_.fateOf(exposure.sequence).dropped && exposure.sequence >= ready_)
        return std::move(exposure);
    }
    taken_ = feed_->take();
    next_ = 0;
    if (taken_.empty()) return std::nullopt;
  }
}

std::vector<Frame> TwinFrameSource::nextBatch(std::size_t max) { return nextWindowed(max, nullptr); }

std::vector<Frame> TwinFrameSource::nextWindowed(std::size_t max, const WindowsFor& windows) {
  struct Order {
    twin::Exposure exposure;
    std::uint64_t sequence{};
    std::vector<PixelWindow> windows;
  };
  const twin::CameraDescription& camera = camera_.description();
  const std::vector<PixelWindow> whole{{0, 0, camera.width_px, camera.height_px}};
  std::vector<Order> orders;
  while (orders.size() < max) {
    std::optional<twin::Exposure> taken = next();
    if (!taken) break;
    const std::uint64_t number = taken->sequence - missed_;
    Order& order = orders.emplace_back(Order{std::move(*taken), number, {}});
    const twin::Exposure& exposure = order.exposure;
    if (windows) order.windows = windows(exposure.start_s);
    const double read_s =
        windows ? camera.read_out.time_s(order.windows.empty() ? whole : order.windows, camera.bits) : 0.0;
    const double periods = std::max(1.0, std::ceil(read_s / camera.frame_period_s - kRounding));
    ready_ = exposure.sequence + static_cast<std::uint64_t>(periods);
    missed_ += ready_ - exposure.sequence - 1;
  }
  std::vector<Frame> frames(orders.size());
  base::forEachIndex(orders.size(), threads_, [&](std::size_t i) {
    const Order& order = orders[i];
    frames[i] = order.windows.empty() ? camera_.render(order.exposure)
                                      : camera_.render(order.exposure, order.windows);
    frames[i].sequence = order.sequence;
    frames[i].start_s += camera_.fateOf(order.exposure.sequence).stamp_error_s;
  });
  return frames;
}

}  // namespace kerfbench::camera
