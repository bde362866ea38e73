// SPDX-License-Identifier: Apache-2.0
#include "light_at_rest.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace own {
namespace {

using namespace kerfbench;

/// Times at which any drive was told to step, either edge of its PUL; by time.
std::vector<double> stepsOf(const source::PinRecording& recording, const evidence::PinWiring& wiring) {
  std::vector<double> steps_s;
  for (const PinEvent& event : recording.outputs) {
    const bool is_step = std::ranges::any_of(wiring.drives, [&](const evidence::DriveWiring& drive) {
      const auto pin = wiring.signals.pin(drive.pul);
      return pin && pin->port == event.port && (event.changed >> pin->bit & 1U) != 0;
    });
    if (is_step) steps_s.push_back(recording.rate.seconds(event.tick));
  }
  return steps_s;
}

}  // namespace

inspect::Check lightAtRest(const source::PinRecording& recording, const evidence::PinWiring& wiring,
                           double limit_ms) {
  const std::vector<double> steps_s = stepsOf(recording, wiring);
  double longest_s = std::numeric_limits<double>::quiet_NaN();
  double begun_s = 0.0;
  for (const inspect::Span& light : evidence::pinEvidence(recording, wiring).light) {
    double from_s = light.from_s;
    auto step = std::ranges::lower_bound(steps_s, light.from_s);
    while (true) {
      const bool is_last = step == steps_s.end() || *step >= light.to_s;
      const double until_s = is_last ? light.to_s : *step;
      // Not the larger of the two: the first replaces NaN.
      if (!(until_s - from_s <= longest_s)) {
        longest_s = until_s - from_s;
        begun_s = from_s;
      }
      if (is_last) break;
      from_s = *step++;
    }
  }
  const double stamp_s = recording.rate.seconds(1 + recording.stamp_err_ticks);
  inspect::Check check{.name = "light_at_rest", .title = "Light while no drive is stepped", .unit = "ms"};
  check.value = 1e3 * longest_s;
  check.limit = limit_ms;
  check.u = 1e3 * 2.0 * stamp_s;
  check.where.time = inspect::Whereabouts::Time::kPins;
  check.where.time_s = begun_s;
  inspect::decide(check);
  return check;
}

}  // namespace own
