// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/power_payload.h"

#include <algorithm>
#include <cmath>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/power/loop.h"
#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::planner {
namespace {

/// Most that the gain's byte holds, of 256: the paper's 1.
constexpr std::uint64_t kMostGain = 255;

}  // namespace

Payload powerLoopPayload(const MachineParameters& machine, const JobParameters& job,
                         unsigned gate_delay_ticks) {
  const Target& target = machine.target;
  const PowerModel& model = *job.power;
  const int ticks =
      static_cast<int>(gate_delay_ticks) + 1 +
      static_cast<int>(std::lround((machine.laser_lag_s + machine.power_delay_s) / target.tick_s));
  // A period is prepared while another runs, from the measurement of the one before that.
  const int late = 2 + static_cast<int>(std::ceil(static_cast<double>(ticks) / target.ticks_per_period));
  const double gain = dampedGain(late);
  Payload payload;
  const bool paper = job.power_law == JobParameters::PowerLaw::kPaper;
  append(payload, paper ? kMostGain : static_cast<std::uint64_t>(std::lround(256.0 * gain)), 1);
  append(payload, model.byteFor(0.0), 1);
  append(payload, model.byteFor(model.laser().full_control), 1);
  append(payload, static_cast<std::uint64_t>(ticks), 2);
  for (int i = 0; i < KB_POWER_POINTS; ++i) {
    const auto byte = static_cast<std::uint8_t>(std::min(16 * i, 255));
    // The laser's curve is unknown below its first point; the loop never goes there.
    const double edges = model.powerOf(byte) * target.periodS() / (2.0 * machine.power_quantum_j);
    append(payload, static_cast<std::uint64_t>(std::lround(16.0 * edges)), 2);
  }
  return payload;
}

}  // namespace kerfbench::planner
