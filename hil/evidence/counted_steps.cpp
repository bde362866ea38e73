// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/counted_steps.h"

#include <algorithm>
#include <cmath>

#include "hil/evidence/port_levels.h"

namespace kerfbench::evidence {
namespace {

struct Axis {
  PinId pul, dir;
  bool rising{};
  bool pul_high{};

  /// The step, if any, that the levels after a write bring.
  std::int32_t stepBy(const PortLevels& ports) {
    const bool high = ports.high(pul);
    if (high == pul_high) return 0;
    pul_high = high;
    if (high != rising) return 0;
    return ports.high(dir) ? 1 : -1;
  }
};

}  // namespace

std::optional<CountedSteps> CountedSteps::of(const source::PinRecording& recording, const PinWiring& wiring) {
  std::vector<Axis> axes;
  for (const DriveWiring& drive : wiring.drives) {
    const std::optional<PinId> pul = wiring.signals.pin(drive.pul);
    const std::optional<PinId> dir = wiring.signals.pin(drive.dir);
    if (axes.size() == 2) break;
    if (!pul || !dir) return std::nullopt;
    axes.push_back({*pul, *dir, drive.profile.active_edge_rising});
  }
  if (axes.size() < 2) return std::nullopt;
  CountedSteps counted;
  PortLevels ports;
  Steps now{0, 0};
  for (const PinEvent& event : recording.outputs.streamed()) {
    const auto period =
        static_cast<std::size_t>(std::max(0.0, recording.rate.seconds(event.tick)) / kRaster_s);
    while (counted.steps_.size() < period) counted.steps_.push_back(now);
    ports.apply(event);
    for (std::size_t i = 0; i < 2; ++i) now[i] += axes[i].stepBy(ports);
  }
  counted.steps_.push_back(now);
  return counted;
}

std::size_t CountedSteps::indexAt(double time_s) const {
  const double period = std::floor(time_s / kRaster_s);
  if (!(period > 0.0)) return 0;
  return std::min(static_cast<std::size_t>(period), steps_.size() - 1);
}

CountedSteps::Steps CountedSteps::at(double time_s) const { return steps_[indexAt(time_s)]; }

void CountedSteps::passed(double time_s) const { steps_.giveBack(0, indexAt(time_s)); }

}  // namespace kerfbench::evidence
