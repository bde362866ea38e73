// SPDX-License-Identifier: Apache-2.0
// Lost steps at the edge of pull-out, compared with an integrator by hand.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/studies.h"
#include "tests/validation/support/motion.h"
#include "tests/validation/support/rk4.h"
#include "tests/validation/support/solvers.h"
#include "tests/validation/support/svg.h"
#include "twin/drive/pulse_command.h"

namespace kerfbench::validation {
namespace {

using Edges = std::vector<twin::StepEdge>;

// A 17HS4401 with a flywheel.
constexpr double kHolding = 0.40, kDetent = 0.022, kDamping = 1.5e-3, kCurrent = 1.7;
constexpr double kSupply_v = 36.0, kResistance = 1.5, kInductance = 2.8e-3;
constexpr double kInertia = 3.0e-5;
constexpr int kTeeth = 50;
constexpr double kPulse_rad = 2.0 * std::numbers::pi / 3200.0;
constexpr double kAcceleration_rad_s2 = 1500.0;
constexpr double kCalm_s = 0.15;

// Profile up to the speed, 10 ms at it, and down again.
struct Ramp {
  double top_rad_s{};
  Motion motion{Eigen::Vector2d::Zero()};
  Edges edges;
  double end_s{};
};

Ramp rampTo(double top_rad_s) {
  Ramp ramp;
  ramp.top_rad_s = top_rad_s;
  const double way_rad = top_rad_s * top_rad_s / kAcceleration_rad_s2 + top_rad_s * 0.01;
  ramp.motion.line({way_rad, 0.0}, {0.0, top_rad_s, 0.0, kAcceleration_rad_s2}, false);
  ramp.end_s = std::ceil((ramp.motion.duration_s() + kCalm_s) / 100e-6) * 100e-6;
  ramp.edges =
      pulsesFor([&](double time_s) { return ramp.motion.at_mm(time_s).x(); }, kPulse_rad, ramp.end_s);
  return ramp;
}

// Number of teeth that the rotor stayed behind at the end.
long long slipped(const Ramp& ramp, double rotor_rad) {
  double command_rad = 0.0;
  for (const twin::StepEdge& edge : ramp.edges) command_rad += edge.direction * kPulse_rad;
  return std::llround((command_rad - rotor_rad) * kTeeth / (2.0 * std::numbers::pi));
}

double fieldByHand(double holding, double angle_rad, double speed_rad_s, double command_rad) {
  const double back_v = kHolding / kCurrent * std::abs(speed_rad_s);
  const double reactance = kTeeth * kInductance * std::abs(speed_rad_s);
  const double most_a = std::max(0.0, kSupply_v - back_v) / std::hypot(kResistance, reactance);
  const double share = std::min(1.0, most_a / kCurrent);
  return -holding * share * std::sin(kTeeth * (angle_rad - command_rad)) -
         kDetent * std::sin(4.0 * kTeeth * angle_rad);
}

long long slippedByHand(const Ramp& ramp, double holding) {
  constexpr double kStep_s = 0.2e-6;
  std::array<double, 2> y{};
  double command_rad = 0.0;
  std::size_t next = 0;
  const auto steps = std::llround(ramp.end_s / kStep_s);
  for (long long i = 0; i < steps; ++i) {
    const double now_s = static_cast<double>(i) * kStep_s;
    while (next < ramp.edges.size() && ramp.edges[next].time_s < now_s + 1e-9) {
      command_rad += ramp.edges[next++].direction * kPulse_rad;
    }
    rk4Step(y, now_s, kStep_s, [=](double, const auto& at, auto& rate) {
      rate[0] = at[1];
      rate[1] = (fieldByHand(holding, at[0], at[1], command_rad) - kDamping * at[1]) / kInertia;
    });
  }
  return slipped(ramp, y[0]);
}

std::shared_ptr<const twin::Mechanism> motor() {
  twin::StepperDescription stepper;
  stepper.holding_torque_nm = kHolding;
  stepper.detent_torque_nm = kDetent;
  stepper.damping_nm_s = kDamping;
  stepper.rated_current_a = kCurrent;
  stepper.supply_v = kSupply_v;
  stepper.resistance_ohm = kResistance;
  stepper.inductance_h = kInductance;
  stepper.rotor_teeth = kTeeth;
  twin::MechanismDescription d;
  twin::JointDescription rotor;
  rotor.name = "rotor";
  rotor.mass_kg = 0.1;
  rotor.inertia_kg_m2 = kInertia;
  d.joints = {rotor};
  twin::JointDrive drive;
  drive.name = "stepper";
  drive.drive = stepper;
  drive.inertia_kg_m2 = kInertia;
  d.drives = {drive};
  return std::make_shared<twin::Mechanism>(std::move(d));
}

long long slippedOfTwin(const Ramp& ramp, double step_s, twin::Fidelity fidelity) {
  const auto solver = solverOf(motor(), step_s, fidelity);
  twin::PulseCommand command(kPulse_rad);
  command.incoming() = ramp.edges;
  const auto steps = std::llround(ramp.end_s / step_s);
  for (long long i = 0; i < steps; ++i) {
    const double begin_s = static_cast<double>(i) * step_s;
    const double mean = command.meanOver(begin_s, static_cast<double>(i + 1) * step_s);
    const twin::DriveCommand input{mean, mean, mean};
    solver->step(begin_s, {&input, 1});
  }
  return slipped(ramp, solver->q()[0]);
}

struct Trial {
  std::string name;
  double step_s;
  twin::Fidelity fidelity;
  int equal{};   ///< Number of decided ramps with equal counts.
  int of_all{};  ///< Number of all ramps with equal counts.
};

// Truth of a ramp. A rotor that slips over many teeth is caught by a hair, and the hair has a structure of
// its own: the count is a matter of the physics only if it stays when the holding torque changes by up to a
// thousandth, a tolerance that no motor has.
struct Truth {
  long long teeth{};
  bool decided{true};
};

Truth truthOf(const Ramp& ramp) {
  Truth truth{slippedByHand(ramp, kHolding)};
  for (const double hair : {-1e-3, -3e-4, -1e-4, -3e-5, 3e-5, 1e-4, 3e-4, 1e-3}) {
    truth.decided = truth.decided && slippedByHand(ramp, (1.0 + hair) * kHolding) == truth.teeth;
  }
  return truth;
}

constexpr double kLow_rad_s = 104.0, kHigh_rad_s = 112.0;

/// Counts over all ramps, with a row of the table for each.
struct Counts {
  std::vector<Trial> trials{{"reference, 5 µs", 5e-6, twin::Fidelity::kReference},
                            {"reference, 10 µs", 10e-6, twin::Fidelity::kReference},
                            {"reference, 20 µs", 20e-6, twin::Fidelity::kReference},
                            {"fast, 10 µs", 10e-6, twin::Fidelity::kFast}};
  PlotLine truth{"integrator by hand, 0.2 µs", {}, true, false};
  PlotLine reference{"reference solver, 10 µs", {}, false, true};
  int with_loss{0};
  int decided{0};
  std::vector<std::vector<std::string>> rows;
};

void add(Counts& counts, const Ramp& ramp) {
  const Truth by_hand = truthOf(ramp);
  counts.decided += by_hand.decided ? 1 : 0;
  counts.with_loss += by_hand.decided && by_hand.teeth != 0 ? 1 : 0;
  counts.truth.points.emplace_back(ramp.top_rad_s, 4.0 * static_cast<double>(by_hand.teeth));
  std::vector<std::string> row{fmt::format("{:.2f}", ramp.top_rad_s),
                               std::to_string(4 * by_hand.teeth) + (by_hand.decided ? "" : " by a hair")};
  for (Trial& trial : counts.trials) {
    const long long found = slippedOfTwin(ramp, trial.step_s, trial.fidelity);
    trial.equal += by_hand.decided && found == by_hand.teeth ? 1 : 0;
    trial.of_all += found == by_hand.teeth ? 1 : 0;
    row.push_back(std::to_string(4 * found));
    if (trial.step_s == 10e-6 && trial.fidelity == twin::Fidelity::kReference) {
      counts.reference.points.emplace_back(ramp.top_rad_s, 4.0 * static_cast<double>(found));
    }
  }
  counts.rows.push_back(std::move(row));
}

}  // namespace

Section pullOut(const Context& context) {
  const int ramps = context.effort == Effort::kQuick ? 5 : 33;
  Counts counts;
  for (int i = 0; i < ramps; ++i)
    add(counts, rampTo(kLow_rad_s + (kHigh_rad_s - kLow_rad_s) * i / (ramps - 1)));
  Section section;
  section.title = "Lost steps at the edge of pull-out";
  section.markdown = fmt::format(
      "A 17HS4401 on 36 V with a flywheel of 3e-5 kg m² follows {} ramps of {:g} rad/s² up to {:g} … {:g} "
      "rad/s and back, in\nsixteenths of a step. Its field weakens with speed; near the top it lets go, and "
      "is "
      "caught again on the way down. Full\nsteps lost in the end. The truth is the pendulum equation by hand "
      "in "
      "steps of 0.2 µs. {} ramps are decided: by hand, no\nchange of the holding torque by up to a "
      "thousandth "
      "changes the count. The others are marked: the rotor is caught by a hair.\n\n",
      ramps, kAcceleration_rad_s2, kLow_rad_s, kHigh_rad_s, counts.decided);
  std::vector<std::string> head{"top speed, rad/s", "by hand"};
  for (const Trial& trial : counts.trials) head.push_back(trial.name);
  section.markdown += markdownTable(head, counts.rows);
  for (const Trial& trial : counts.trials) {
    section.atLeast("decided ramps with the same count as by hand: " + trial.name, trial.equal,
                    counts.decided, "");
  }
  section.markdown += "Equal counts of all ramps, decided or not: ";
  for (const Trial& trial : counts.trials) {
    section.markdown += fmt::format("{}{} {} of {}", &trial == counts.trials.data() ? "" : ", ", trial.name,
                                    trial.of_all, ramps);
  }
  section.markdown += ".\n\n";
  section.atLeast("decided ramps that lose steps", counts.with_loss, std::max(1, ramps / 6), "");
  section.atLeast("decided ramps that lose none", counts.decided - counts.with_loss, std::max(1, ramps / 6),
                  "");
  section.figures.push_back({"pull-out", "Full steps lost over the ramp's top speed",
                             svgOf(LinePlot{"Lost steps at the edge of pull-out",
                                            {"top speed, rad/s"},
                                            {"full steps"},
                                            {counts.truth, counts.reference}})});
  return section;
}

}  // namespace kerfbench::validation
