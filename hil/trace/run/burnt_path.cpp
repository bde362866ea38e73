// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/burnt_path.h"

#include <algorithm>
#include <cmath>

#include "hil/trace/run/chord.h"
#include "hil/trace/topics.h"

namespace kerfbench::trace {
namespace {

// More points are not looked at for one chord, so that each costs the same.
constexpr std::size_t kLongest = 64;

double secondOf(double time_s) { return kBurntSpan_s * std::floor(time_s / kBurntSpan_s); }

}  // namespace

void BurntPath::keep(const Point& point, bool begins) {
  time_.add(point.time_s, kSeconds);
  x_.add(point.p_mm.x(), kMm);
  y_.add(point.p_mm.y(), kMm);
  start_.add(begins ? 1 : 0);
}

bool BurntPath::isStraightTo(const Point& point) const {
  return open_.size() < kLongest && std::ranges::all_of(open_, [&](const Point& between) {
           return distanceToChord_mm(between.p_mm, open_.front().p_mm, point.p_mm) <= kTolerance_mm;
         });
}

void BurntPath::finishPath() {
  if (open_.size() > 1) keep(open_.back(), false);
  open_.clear();
}

std::optional<BurntPath::Message> BurntPath::take() {
  if (!second_ || time_.empty()) return std::nullopt;
  Message message{*second_, "{"};
  appendColumn(message.json, "t_s", time_);
  appendColumn(message.json, "x_mm", x_);
  appendColumn(message.json, "y_mm", y_);
  appendColumn(message.json, "start", start_);
  message.json.push_back('}');
  for (JsonColumn* column : {&time_, &x_, &y_, &start_}) column->clear();
  return message;
}

std::optional<BurntPath::Message> BurntPath::add(double time_s, const Eigen::Vector2d& p_S_mm, bool lit) {
  const Point point{time_s, p_S_mm};
  const Point before = before_;
  before_ = point;
  if (!lit || !p_S_mm.allFinite() || !before.p_mm.allFinite()) {
    finishPath();
    return std::nullopt;
  }
  std::optional<Message> complete;
  if (second_ != secondOf(before.time_s)) {
    finishPath();
    complete = take();
    second_ = secondOf(before.time_s);
  }
  if (open_.empty()) {
    keep(before, true);
    open_.push_back(before);
  } else if (!isStraightTo(point)) {
    const Point corner = open_.back();
    keep(corner, false);
    open_.assign(1, corner);
  }
  open_.push_back(point);
  return complete;
}

std::optional<BurntPath::Message> BurntPath::end() {
  finishPath();
  return take();
}

}  // namespace kerfbench::trace
