// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/sheet_feed.h"

#include <utility>

namespace kerfbench::camera {

void SheetFeed::add(std::shared_ptr<const twin::Sheet> piece) {
  std::unique_lock lock(mutex_);
  taken_.wait(lock, [this] { return closed_ || pieces_.size() < most_waiting_; });
  if (closed_) return;
  pieces_.push_back(std::move(piece));
  more_.notify_one();
}

void SheetFeed::end(std::shared_ptr<const twin::Sheet> rest) {
  const std::scoped_lock lock(mutex_);
  rest_ = std::move(rest);
  more_.notify_all();
}

std::shared_ptr<const twin::Sheet> SheetFeed::take() {
  std::unique_lock lock(mutex_);
  more_.wait(lock, [this] { return closed_ || rest_ || !pieces_.empty(); });
  if (closed_) return nullptr;
  if (pieces_.empty()) return rest_;
  std::shared_ptr<const twin::Sheet> piece = std::move(pieces_.front());
  pieces_.pop_front();
  taken_.notify_one();
  return piece;
}

void SheetFeed::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  pieces_.clear();
  more_.notify_all();
  taken_.notify_all();
}

}  // namespace kerfbench::camera
