// SPDX-License-Identifier: Apache-2.0
// Eight coupled joints compared with equations of motion written by hand.
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/studies.h"
#include "tests/validation/support/svg.h"
#include "tests/validation/support/twin_eight.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::validation {
namespace {

using Accelerations = twin::ReferenceSolver::Accelerations;

// Interval of the truth: every 100 us, a multiple of every step that is tried.
constexpr double kLook_s = 100e-6;

std::vector<EightJoints::Values> truthOver(double end_s, const EightJoints& machine) {
  HandEight hand(machine);
  const auto per_look = std::llround(kLook_s / HandEight::kStep_s);
  const auto looks = std::llround(end_s / kLook_s);
  std::vector<EightJoints::Values> result;
  for (long long i = 0; i < looks; ++i) {
    for (long long k = 0; k < per_look; ++k) hand.stepSmooth(EightJoints::smooth);
    result.push_back(hand.q());
  }
  return result;
}

std::vector<twin::DriveCommand> commandsOver(double begin_s, double step_s) {
  const auto begin = EightJoints::smooth(begin_s);
  const auto middle = EightJoints::smooth(begin_s + 0.5 * step_s);
  const auto end = EightJoints::smooth(begin_s + step_s);
  std::vector<twin::DriveCommand> commands;
  for (std::size_t i = 0; i < EightJoints::kDrives; ++i) commands.push_back({begin[i], middle[i], end[i]});
  return commands;
}

EightErrors errorsOf(const std::vector<EightJoints::Values>& truth, const EightJoints& machine, double step_s,
                     Accelerations accelerations) {
  twin::ReferenceSolver solver(twinEight(machine), step_s, accelerations);
  const auto per_look = std::llround(kLook_s / step_s);
  EightErrors errors;
  long long n = 0;
  for (const auto& wanted : truth) {
    for (long long k = 0; k < per_look; ++k, ++n) {
      const double begin_s = static_cast<double>(n) * step_s;
      solver.step(begin_s, commandsOver(begin_s, step_s));
    }
    errors.add(wanted, jointsOf(solver.q()));
  }
  return errors;
}

double largestSpot_mm(const std::vector<EightJoints::Values>& truth) {
  double largest = 0.0;
  for (const auto& q : truth) largest = std::max(largest, EightJoints::spot_mm(q).norm());
  return largest;
}

}  // namespace

Section eightJoints(const Context& context) {
  const double end_s = context.effort == Effort::kQuick ? 0.05 : 0.4;
  const EightJoints machine;
  const auto truth = truthOver(end_s, machine);
  Section section;
  section.title = "Eight coupled joints against an integrator by hand";
  section.markdown = fmt::format(
      "Roller, belt on a 100 Hz spring, gantry x and y, and on its carriage two shafts of rotor and mirror "
      "with a 4 kHz torsion\nat 1 % of critical, one driven by a stepper's magnetic spring (196 Hz), one by "
      "a "
      "1200 Hz servo; mirrors 20 µm out of\nbalance, so that they shake the gantry and gravity turns one. "
      "Smooth command of {:g} s, spot up to {:.0f} mm from the\norigin. The truth is a mass matrix in closed "
      "form and RK4 in steps of 0.2 µs (`support/hand_eight.cpp`): no Bullet, no\nline of the twin.\n\n",
      end_s, largestSpot_mm(truth));
  std::vector<std::vector<std::string>> rows;
  PlotLine line{"articulated bodies in each stage", {}, true, true};
  EightErrors at_10us;
  EightErrors frozen_at_10us;
  for (const double step_us : {5.0, 10.0, 20.0, 50.0}) {
    const auto row = [&](const char* name, Accelerations accelerations) {
      try {
        const auto errors = errorsOf(truth, machine, step_us * 1e-6, accelerations);
        rows.push_back({name, fmt::format("{:g}", step_us), figureText(errors.spot_um, 1e-7),
                        figureText(errors.belt_um, 1e-7), figureText(errors.gantry_um, 1e-7)});
        return errors;
      } catch (const std::invalid_argument&) {
        rows.push_back({name, fmt::format("{:g}", step_us), "refused", "refused", "refused"});
        return EightErrors{std::nan(""), std::nan(""), std::nan("")};
      }
    };
    const auto errors = row("articulated bodies in each stage", Accelerations::kEveryStage);
    const auto frozen = row("once a step, as the machine does", Accelerations::kOnceAStep);
    line.points.emplace_back(step_us, errors.spot_um);
    if (step_us == 10.0) at_10us = errors;
    if (step_us == 10.0) frozen_at_10us = frozen;
  }
  section.markdown +=
      markdownTable({"reference solver", "step, µs", "spot, µm", "belt, µm", "gantry, µm"}, rows);
  section.markdown +=
      "A step that cannot follow the torsion is refused by name: the solver's bound is step x rate <= 1.\n";
  section.atMost("spot at 10 µs, reference solver", at_10us.spot_um, 1.0, "µm", 1e-7);
  section.atMost("belt at 10 µs", at_10us.belt_um, 1.0, "µm", 1e-7);
  section.atMost("gantry at 10 µs", at_10us.gantry_um, 1.0, "µm", 1e-7);
  section.atMost("spot at 10 µs, articulated bodies once a step", frozen_at_10us.spot_um, 1.0, "µm", 1e-7);
  section.figures.push_back({"eight-joints", "Largest error of the spot over the step",
                             svgOf(LinePlot{"Eight joints: largest error of the spot",
                                            {"step, µs", true},
                                            {"µm", true},
                                            {line},
                                            {{1.0, "1 µm"}}})});
  return section;
}

}  // namespace kerfbench::validation
