// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/pin_stamps.h"

#include <fmt/format.h>

#include <cmath>

namespace kerfbench::judge {

double pinUncertainty_s(const source::PinRecording& recording) {
  return recording.rate.seconds(recording.stamp_err_ticks) / std::sqrt(3.0);
}

std::vector<std::string> unprovenSteps(std::span<const PulseTiming> pulses, double stamp_err_s) {
  std::vector<std::string> words;
  if (stamp_err_s <= 0.0) return words;
  for (const PulseTiming& timing : pulses) {
    const auto look = [&](const char* kind, std::uint64_t violations, double seen_s, double required_s) {
      // A time is the difference of two stamps.
      if (violations == 0 || seen_s + 2.0 * stamp_err_s < required_s) return;
      words.push_back(fmt::format(
          "{}: the {} is {:.4g} us by stamps that are off by up to {:.4g} us, and the drive asks for "
          "{:.4g} us: what it makes of {} pulses is not known",
          timing.axis, kind, 1e6 * seen_s, 1e6 * stamp_err_s, 1e6 * required_s, violations));
    };
    look("DIR set-up", timing.setup_violations, timing.min_setup_s, timing.profile.setup_s);
    look("DIR hold", timing.hold_violations, timing.min_hold_s, timing.profile.hold_s);
    look("pulse width", timing.width_violations, timing.min_width_s, timing.profile.width_s);
    look("pulse space", timing.space_violations, timing.min_space_s, timing.profile.space_s);
    look("time from enable to DIR or PUL", timing.enable_setup_violations, timing.min_enable_setup_s,
         timing.profile.enable_setup_s);
  }
  return words;
}

}  // namespace kerfbench::judge
