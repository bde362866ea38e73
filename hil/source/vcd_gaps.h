// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hil/source/pin_events.h"
#include "twin/base/pin_event.h"

namespace kerfbench::source {

// Private to this room.

/// Gaps as the header of a VCD file lists them, which become flags of events, or events of their own where
/// the gap's own edges were on pins that are not wired.
class VcdGaps {
 public:
  /// Before the first event.
  void add(Tick tick, std::uint16_t port) {
    gaps_.push_back({tick, port});
    is_sorted_ = false;
  }

  [[nodiscard]] bool none() const { return gaps_.empty(); }
  /// Appends the gaps before an instant, and marks those in it. `instant`: all events of one tick, to be
  /// appended next.
  void put(std::vector<PinEvent>& instant, PinEvents& outputs) {
    if (gaps_.empty() || instant.empty()) return;
    sort();
    const Tick tick = instant.front().tick;
    for (; next_ < gaps_.size() && gaps_[next_].tick < tick; ++next_) putAlone(gaps_[next_], outputs);
    for (; next_ < gaps_.size() && gaps_[next_].tick == tick; ++next_) {
      const Gap& gap = gaps_[next_];
      const auto event = std::ranges::find(instant, gap.port, &PinEvent::port);
      if (event != instant.end()) {
        event->flags |= PinEvent::kGap;
      } else {
        instant.push_back({tick, gap.port, 0, levels_[gap.port], PinEvent::kGap});
      }
    }
    for (const PinEvent& event : instant) levels_[event.port] = event.level;
  }
  /// Appends those after the last event.
  void putRest(PinEvents& outputs) {
    sort();
    for (; next_ < gaps_.size(); ++next_) putAlone(gaps_[next_], outputs);
  }

 private:
  struct Gap {
    Tick tick{};
    std::uint16_t port{};
  };

  void sort() {
    if (is_sorted_) return;
    std::ranges::stable_sort(gaps_, {}, &Gap::tick);
    levels_.resize(std::size_t{1} << 16U);
    is_sorted_ = true;
  }
  void putAlone(const Gap& gap, PinEvents& outputs) {
    if (gap.tick != alone_tick_) alone_.clear();
    alone_tick_ = gap.tick;
    if (std::ranges::find(alone_, gap.port) != alone_.end()) return;  // One that is listed twice is one.
    alone_.push_back(gap.port);
    outputs.push_back({gap.tick, gap.port, 0, levels_[gap.port], PinEvent::kGap});
  }

  std::vector<Gap> gaps_;
  bool is_sorted_{true};
  std::size_t next_{};
  std::vector<std::uint16_t> levels_;  ///< Levels of each port after the last event.
  Tick alone_tick_{};
  std::vector<std::uint16_t> alone_;  ///< Ports of the gaps at alone_tick_ that are events of their own.
};

}  // namespace kerfbench::source
