// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/machine_run.h"

#include <cmath>
#include <limits>

namespace kerfbench::validation {

twin::WebDescription restingWeb() {
  twin::WebDescription web;
  web.print.pitch_mm = 1000.0;
  return web;
}

MachineRun runMachine(const twin::MachineDescription& machine, const twin::WebDescription& web,
                      const Motion& motion, double tail_s, twin::Fidelity fidelity) {
  constexpr double kStep_s = twin::MachineModel::kStep_s;
  constexpr double kCalm_s = 0.2;
  const bool gantry = machine.kind == twin::MachineDescription::Kind::kGantry;
  const Speeds slow{0.0, 100.0, 0.0, 1000.0};
  const PaperHead head{machine.head.throw_mm, machine.head.mirror_spacing_mm};
  Motion approach(Eigen::Vector2d::Zero());
  const Eigen::Vector2d start = motion.at_mm(0.0);
  if (start.norm() > 0) approach.line(start, slow, false);
  approach.rest(kCalm_s);
  const double lead_s = std::ceil(approach.duration_s() / kStep_s) * kStep_s;
  const double end_s = lead_s + motion.duration_s() + tail_s;
  const auto target = [&](Eigen::Index axis) {
    return [&, axis](double time_s) {
      const auto place = time_s < lead_s ? approach.at_mm(time_s) : motion.at_mm(time_s - lead_s);
      return gantry ? place[axis] : head.angles_rad(place)[axis];
    };
  };
  twin::MachineModel model(machine, web, fidelity);
  const twin::Axis x = gantry ? twin::Axis::kGantryX : twin::Axis::kGalvoX;
  const twin::Axis y = gantry ? twin::Axis::kGantryY : twin::Axis::kGalvoY;
  model.command(x).incoming() = pulsesFor(target(0), twin::axisOf(machine, x).step, end_s);
  model.command(y).incoming() = pulsesFor(target(1), twin::axisOf(machine, y).step, end_s);
  MachineRun run;
  const auto steps = static_cast<long long>(std::ceil(end_s / kStep_s));
  const auto lead_steps = std::llround(lead_s / kStep_s);
  for (long long i = 0; i < steps; ++i) {
    model.run(static_cast<std::uint64_t>(i), 1);
    if (i < lead_steps) continue;
    const auto spot = model.spot();
    run.time_s.push_back(static_cast<double>(i + 1 - lead_steps) * kStep_s);
    run.spot_mm.push_back(spot ? spot->p_WQ_mm
                               : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
  run.lost = model.lostSteps();
  for (twin::LostSteps& lost : run.lost) lost.time_s -= lead_s;
  return run;
}

}  // namespace kerfbench::validation
