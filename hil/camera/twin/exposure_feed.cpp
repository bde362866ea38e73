// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/exposure_feed.h"

#include <iterator>
#include <stdexcept>
#include <utility>

namespace kerfbench::camera {
namespace {

// Waiting for some costs less than being woken for each.
constexpr std::size_t kAFew = 16;

}  // namespace

void ExposureFeed::add(std::vector<twin::Exposure> exposures) {
  const std::scoped_lock lock(mutex_);
  for (twin::Exposure& exposure : exposures) {
    if (last_ && exposure.sequence <= *last_)
      throw std::invalid_argument("ExposureFeed: exposures out of order");
    last_ = exposure.sequence;
    if (!closed_) exposures_.push_back(std::move(exposure));
  }
  countTakeable();
}

void ExposureFeed::want(double from_s, double to_s) {
  std::unique_lock lock(mutex_);
  while (!exposures_.empty() && takeable_ == 0 && exposures_.front().start_s < from_s) exposures_.pop_front();
  to_s_ = to_s;
  countTakeable();
  taken_.wait(lock, [this] { return closed_ || takeable_ <= most_waiting_; });
}

void ExposureFeed::end() {
  const std::scoped_lock lock(mutex_);
  ended_ = true;
  more_.notify_all();
}

std::vector<twin::Exposure> ExposureFeed::take() {
  std::unique_lock lock(mutex_);
  more_.wait(lock, [this] { return closed_ || ended_ || takeable_ >= kAFew; });
  const auto end = exposures_.begin() + static_cast<std::ptrdiff_t>(takeable_);
  std::vector<twin::Exposure> taken(std::move_iterator(exposures_.begin()), std::move_iterator(end));
  exposures_.erase(exposures_.begin(), end);
  takeable_ = 0;
  taken_.notify_one();
  return taken;
}

void ExposureFeed::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  exposures_.clear();
  takeable_ = 0;
  more_.notify_all();
  taken_.notify_all();
}

void ExposureFeed::countTakeable() {
  while (takeable_ < exposures_.size() && exposures_[takeable_].start_s <= to_s_) ++takeable_;
  if (takeable_ >= kAFew) more_.notify_one();
}

}  // namespace kerfbench::camera
