// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/strip_twin.h"

#include <cmath>
#include <stdexcept>

#include "tests/validation/strip_line.h"
#include "twin/cutter/twin.h"

namespace kerfbench::validation {

std::vector<double> cutTimesOfTwin_s(const twin::MachineDescription& machine, const StripJob& job,
                                     twin::Fidelity fidelity, int pieces) {
  constexpr Tick kStepTicks = 160;
  const double edge_mm = 0.5 * job.width_mm;
  twin::Twin twin(machine, stripWeb(job), kStripRate, {.fidelity = fidelity});
  StripController controller(job, machine, kStripRate);
  std::vector<double> times;
  std::vector<PinEvent> events;
  Tick now = 0;
  while (static_cast<int>(times.size()) < pieces) {
    const double sense = StripController::sense(static_cast<int>(times.size()) + 1);
    const double y = sense * twin.truth().p_WQ_mm.y();
    const bool near = std::abs(y - edge_mm) < 0.6;
    const Tick until = now + (near ? kStepTicks : kStepTicks * 50);
    events.clear();
    controller.advance(until, events);
    (void)twin.predictSensors(until);
    twin.advance(until, events);
    (void)twin.takeExposures();
    now = until;
    const twin::MachinePose pose = twin.pose();
    const double x = twin.truth().p_WQ_mm.x() - pose.belt_travel_mm - pose.sheet_slip_mm.x();
    if (near && twin.sheet().depthAt({x, sense * edge_mm}) >= 1.0) {
      times.push_back(kStripRate.seconds(now));
    } else if (kStripRate.seconds(now) > 2.0 * job.formula_s(pieces) + 20.0) {
      throw std::runtime_error("a piece does not come off the strip");
    }
  }
  return times;
}

}  // namespace kerfbench::validation
