// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "hil/camera/twin/sheet_feed.h"
#include "twin/cutter/twin.h"

// Private to this room: whoever includes this holds a twin.

namespace kerfbench::run {

/// Parts the web behind each unit that has left the machine for good, and hands the piece to the kerf camera.
class PassingWeb {
 public:
  /// `partings_S_mm`: where it is parted, x in S of unit 0, from unit 0 on. `gone_x_W_mm`: the beam reaches
  /// no web beyond.
  PassingWeb(std::shared_ptr<camera::SheetFeed> feed, std::vector<double> partings_S_mm, double gone_x_W_mm)
      : feed_(std::move(feed)), partings_S_mm_(std::move(partings_S_mm)), gone_x_W_mm_(gone_x_W_mm) {}

  /// Hands on what has passed by now. Waits while the camera is far behind.
  void look(twin::Twin& twin) {
    while (next_ < partings_S_mm_.size() && twin.webX_mm() + partings_S_mm_[next_] > gone_x_W_mm_) {
      feed_->add(std::make_shared<const twin::Sheet>(twin.partWeb(partings_S_mm_[next_])));
      ++next_;
    }
  }
  /// The run is over; the rest of the web stays with the twin, which must outlive the feed.
  void end(twin::Twin& twin) { feed_->end({std::shared_ptr<void>(), &twin.sheet()}); }

 private:
  std::shared_ptr<camera::SheetFeed> feed_;
  std::vector<double> partings_S_mm_;
  double gone_x_W_mm_;
  std::size_t next_{0};
};

}  // namespace kerfbench::run
