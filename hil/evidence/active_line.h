// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "twin/base/pin_event.h"

namespace kerfbench::evidence {

/// An input of the laser on one of the controller's pins. Until the pin changes for the first time the input
/// is inactive, whatever its active level is: an emulator tells 0 of a pin that nobody drives, as in a reset,
/// and a supply with an active-low input holds that one high.
class ActiveLine {
 public:
  /// `is_low`: active while the pin is low.
  ActiveLine(PinId pin, bool is_low) : pin_(pin), is_low_(is_low) {}

  /// Events by tick. True if this one makes the input active or inactive.
  bool take(const PinEvent& event) {
    if (event.port != pin_.port) return false;
    const bool level = (event.level >> pin_.bit & 1U) != 0;
    if (level == level_) return false;
    level_ = level;
    const bool was_active = is_active_;
    is_active_ = level != is_low_;
    return is_active_ != was_active;
  }
  [[nodiscard]] bool isActive() const { return is_active_; }

 private:
  PinId pin_;
  bool is_low_;
  bool level_{false};
  bool is_active_{false};
};

}  // namespace kerfbench::evidence
