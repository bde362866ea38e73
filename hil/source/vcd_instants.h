// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hil/source/pin_events.h"
#include "hil/source/vcd_gaps.h"
#include "twin/base/pin_event.h"

namespace kerfbench::source {

// Private to this room.

/// Changes of wires become events of ports: those of a port at one tick are one event.
class VcdInstants {
 public:
  VcdGaps& gaps() { return gaps_; }

  /// Changes come by tick. False: the wire changes a second time at this tick.
  bool change(PinId pin, bool high, Tick tick) {
    const bool is_beside = tick == tick_ && changed_ != 0;
    if (!is_beside) flush();
    std::uint16_t& level = levels_[pin.port];
    const auto mask = static_cast<std::uint16_t>(1U << pin.bit);
    level = static_cast<std::uint16_t>(high ? level | mask : level & ~mask);
    if (is_beside) return join(pin.port, mask);
    tick_ = tick;
    port_ = pin.port;
    changed_ = mask;
    return true;
  }

  /// Events of all ticks, and the gaps up to the last of them; the tick that is being read is over.
  PinEvents& flushed() {
    flush();
    return events_;
  }
  void putRestOfGaps() { gaps_.putRest(events_); }

 private:
  /// Another change at the tick that is being read.
  bool join(std::uint16_t port, std::uint16_t mask) {
    if (port == port_) {
      const bool is_first = (changed_ & mask) == 0;
      changed_ |= mask;
      return is_first;
    }
    const auto other = std::ranges::find(beside_, port, &PinEvent::port);
    if (other == beside_.end()) {
      beside_.push_back({tick_, port, mask, 0, PinEvent::kNone});
      return true;
    }
    const bool is_first = (other->changed & mask) == 0;
    other->changed |= mask;
    return is_first;
  }

  [[nodiscard]] PinEvent first() const {
    return {tick_, static_cast<std::uint16_t>(port_), static_cast<std::uint16_t>(changed_), levels_[port_],
            PinEvent::kNone};
  }

  void flush() {
    if (changed_ == 0) return;
    if (beside_.empty() && gaps_.none()) {
      events_.push_back(first());
    } else {
      flushAll();
    }
    changed_ = 0;
  }
  void flushAll() {
    for (PinEvent& other : beside_) other.level = levels_[other.port];
    if (gaps_.none()) {
      events_.push_back(first());
    } else {
      beside_.insert(beside_.begin(), first());
      gaps_.put(beside_, events_);
    }
    events_.append(beside_);
    beside_.clear();
  }

  std::vector<std::uint16_t> levels_ =
      std::vector<std::uint16_t>(std::size_t{1} << 16U);  ///< Levels of each port.
  PinEvents events_;
  VcdGaps gaps_;
  // The first event of the tick that is being read, and those of other ports. Its parts are words of their
  // own: a processor waits where it reads as one what was just written in parts.
  Tick tick_{};
  unsigned port_{};
  unsigned changed_{};  ///< 0: nothing has changed at this tick.
  std::vector<PinEvent> beside_;
};

}  // namespace kerfbench::source
