// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/program/payload.h"
#include "firmware_under_test/planner/program/power_payload.h"
#include "firmware_under_test/planner/program/writer.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using Op = Payload;

/// Layout for a release that ignores the belt: the unit stays where it lay when it would have been half done.
UnitLayout frozen(const UnitPath& unit, UnitLayout layout, const MachineParameters& machine) {
  double low = unit.start_S_mm.x();
  double high = low;
  for (const Block& block : unit.blocks) {
    for (const Sample& sample : block.samples) {
      low = std::min(low, sample.p_S_mm.x());
      high = std::max(high, sample.p_S_mm.x());
    }
  }
  layout.x_ref_mm = 0.5 * (machine.field_min_mm[0] + machine.field_max_mm[0] - low - high);
  layout.park_W_mm = unit.start_S_mm + Vector2d(layout.x_ref_mm, 0.0);
  return layout;
}

/// Writes the periods from rest at the park position to the last mark.
void writeUnit(Writer& writer, const UnitPath& unit, const UnitLayout& layout, double x_ref_mm, double v,
               double tracking_delay_s) {
  const Vector2d park = writer.at();
  for (int k = 1; k <= layout.catch_up_periods; ++k) {
    const double u = static_cast<double>(k) / layout.catch_up_periods;
    writer.period(park + Vector2d(catchUpMm(u, v, layout.catch_up_periods, unit.period_s), 0.0), nullptr, -1);
  }
  int k = layout.catch_up_periods;
  const auto inMachine = [&](const Vector2d& p_S_mm) {
    return Vector2d(p_S_mm.x() + x_ref_mm + v * (k * unit.period_s + tracking_delay_s), p_S_mm.y());
  };
  Vector2d p_S = unit.start_S_mm;
  for (std::size_t i = 0; i < unit.blocks.size(); ++i) {
    const Block& block = unit.blocks[i];
    for (int wait = 0; wait < layout.waits[i]; ++wait) {
      ++k;
      writer.period(inMachine(p_S), nullptr, block.entity);
    }
    for (const Sample& sample : block.samples) {
      ++k;
      p_S = sample.p_S_mm;
      writer.period(inMachine(p_S), &sample, block.entity);
    }
  }
}

/// Path as if the beam ran at its full speed everywhere, for the laser's power.
UnitPath withConstantPower(UnitPath path, double mark_speed_mm_s, double period_s) {
  for (Block& block : path.blocks) {
    for (Sample& sample : block.samples) {
      if (sample.marked_mm > 0.0) sample.marked_mm = sample.z * mark_speed_mm_s * period_s;
    }
  }
  return path;
}

struct Reach {
  Vector2d low, high;
};

/// Ranges of steps that hold the whole field. Steps grow along their own axis, with a table too, so that each
/// is least and most on the rim; for the formulas in a corner or across the middle.
Reach reachOf(const Axes& axes, const MachineParameters& machine) {
  constexpr int kParts = 128;
  const Vector2d low(machine.field_min_mm[0], machine.field_min_mm[1]);
  const Vector2d high(machine.field_max_mm[0], machine.field_max_mm[1]);
  Reach reach{Vector2d::Zero(), Vector2d::Zero()};  // The range begins at the place of the beam at power-on.
  const auto hold = [&](const Vector2d& p_W_mm) {
    const Vector2d steps = axes.stepsAt(p_W_mm);
    reach.low = reach.low.cwiseMin(steps);
    reach.high = reach.high.cwiseMax(steps);
  };
  for (int i = 0; i <= kParts; ++i) {
    const Vector2d between = low + (high - low) * i / kParts;
    for (const Vector2d& end : {low, high}) {
      hold({end.x(), between.y()});
      hold({between.x(), end.y()});
      hold({end.x(), 0.0});
      hold({0.0, end.y()});
    }
  }
  return reach;
}

/// Appends the field of the beam for KB_CONFIG. Variations of the line's speed and runout of an encoder move
/// the following axis away from its plan, which may use the field to its edge.
void appendField(Op& config, const Axes& axes, const MachineParameters& machine, bool follows) {
  constexpr double kWaverMm = 0.5;
  // Places that steppers are commanded to so that their rotors run as wanted.
  const StepperMotors& motors = machine.steppers;
  const double beside = (motors.resonance_hz > 0.0 ? 2.0 : 0.0) + std::asin(std::abs(motors.detent_share)) *
                                                                      2.0 / std::numbers::pi *
                                                                      motors.full_step_pulses;
  const Reach reach = reachOf(axes, machine);
  std::array<std::int32_t, KB_AXES> low{}, high{};
  low.fill(std::numeric_limits<std::int32_t>::min());
  high.fill(std::numeric_limits<std::int32_t>::max());
  for (int i = 0; i < 2; ++i) {
    const auto axis = static_cast<std::size_t>(axes.firstAxis() + i);
    const double waver = beside + (i == 0 && follows ? kWaverMm * axes.xStepsPerMm(Vector2d::Zero()) : 0.0);
    const auto step = [](double steps) { return static_cast<std::int32_t>(std::clamp(steps, -2e9, 2e9)); };
    low.at(axis) = step(std::floor(reach.low[i] - waver));
    high.at(axis) = step(std::ceil(reach.high[i] + waver));
  }
  for (const auto& steps : {low, high})
    for (const std::int32_t step : steps) append(config, static_cast<std::uint32_t>(step), 4);
}

}  // namespace

PowerModel::Setting powerSetting(const Sample& sample, const MachineParameters& machine,
                                 const JobParameters& job) {
  return job.power->at(sample.marked_mm / sample.z / machine.target.periodS(),
                       job.power->depthOf(sample.z, job.half_z));
}

double powerByte(const Sample& sample, const MachineParameters& machine, const JobParameters& job) {
  if (job.power) return job.power->byteFor(powerSetting(sample, machine, job).control);
  const double power_w = job.cut_energy_j_per_mm * sample.marked_mm / machine.target.periodS();
  return power_w / machine.full_power_w * 255.0;
}

namespace {

/// Motion of the web while a program runs, and the speed that the program uses.
struct WebMotion {
  WebMotion(const Solution& solution, const JobParameters& job, const PlannerFaults& faults)
      : v_mm_s(solution.belt_speed_mm_s),
        moving(v_mm_s > 0.0),
        follows(moving && !job.feed_by_controller && !job.belt_by_clock && !faults.ignore_belt &&
                !faults.mean_speed),
        seen_mm_s(faults.ignore_belt ? 0.0 : v_mm_s) {}
  double v_mm_s;
  bool moving;
  bool follows;
  double seen_mm_s;  // Speed in x' = x + v t.
};

/// Delay of the laser in ticks: it waits for the axes, less its own lag.
unsigned laserDelay(const MachineParameters& machine) {
  const double wait_s = std::max(0.0, machine.tracking_delay_s - machine.laser_lag_s);
  return static_cast<unsigned>(std::lround(wait_s / machine.target.tick_s));
}

std::vector<std::uint8_t> configuration(const WebMotion& web, const MachineParameters& machine,
                                        const Axes& axes, double belt_stop_mm_s) {
  std::vector<std::uint8_t> config;
  const double counts_per_mm_s = web.moving ? axes.periodS() / machine.encoder_count_mm * 65536.0 : 0.0;
  append(config, static_cast<std::uint64_t>(std::llround(web.v_mm_s * counts_per_mm_s)), 4);
  const unsigned delay = laserDelay(machine);
  for (const unsigned byte : {delay, delay, 0U})  // The last value is the idle power, 0.
    config.push_back(static_cast<std::uint8_t>(byte));
  const double most = web.follows ? std::min(belt_stop_mm_s * counts_per_mm_s, 1e9) : 0.0;
  append(config, static_cast<std::uint64_t>(std::llround(most)), 4);
  for (int i = 0; i < 2; ++i) config.push_back(static_cast<std::uint8_t>(delay >> 8));
  const PulseSettings& pulses = axes.pulses();
  for (const std::uint8_t byte : {pulses.invert_a, pulses.invert_c, pulses.wide, pulses.wide_ticks})
    config.push_back(byte);
  config.insert(config.end(), pulses.most_steps.begin(), pulses.most_steps.end());
  config.insert(config.end(), pulses.turn_steps.begin(), pulses.turn_steps.end());
  appendField(config, axes, machine, web.follows);
  return config;
}

/// Writes the units of a job, each with the move to its start.
class UnitWriter {
 public:
  UnitWriter(Writer& writer, const WebMotion& web, const MachineParameters& machine, const JobParameters& job,
             const PlannerFaults& faults, double period_s)
      : writer_(writer), web_(web), machine_(machine), job_(job), faults_(faults), period_s_(period_s) {}

  /// Returns the operations of the unit's own periods.
  OpRange write(const Solution& solution, int unit) {
    const UnitPath path = faults_.constant_power
                              ? withConstantPower(solution.pathOf(unit), job_.mark_speed_mm_s, period_s_)
                              : solution.pathOf(unit);
    UnitLayout layout = solution.layoutOf(unit);
    const double planned_mm = layout.x_ref_mm;
    if (web_.moving && faults_.ignore_belt) layout = frozen(path, layout, machine_);
    if (web_.moving && job_.feed_by_controller) {
      startFed(unit, planned_mm, layout);
    } else if (web_.moving) {
      startAtMark(planned_mm, layout);
    } else {
      if (job_.stop_and_go && unit > 0) writer_.feedPitch();
      writer_.reposition(layout.park_W_mm, v_now_mm_s_);
      while (writer_.feedsPitch()) writer_.hold(1);
    }
    const std::size_t begin = writer_.operations();
    writeUnit(writer_, path, layout, layout.x_ref_mm, web_.seen_mm_s, machine_.tracking_delay_s);
    const OpRange range{begin, writer_.operations()};
    if (web_.follows) writer_.follow(false);
    v_now_mm_s_ = web_.seen_mm_s;
    return range;
  }

  void finish() {
    writer_.reposition(Vector2d::Zero(), v_now_mm_s_);
    if (!(web_.moving && job_.feed_by_controller)) return;
    writer_.stopFeed();
    while (!writer_.feedAtTarget()) writer_.hold(1);
  }

 private:
  /// Starts a timed unit: at the first border of a period at which the web has come far enough.
  void startFed(int unit, double planned_mm, UnitLayout& layout) {
    const double v = web_.v_mm_s;
    const double from_mm = job_.web_start_x_mm - unit * job_.pitch_mm + feedRampMm(v, job_, period_s_);
    const double start_mm =
        from_mm + std::ceil((planned_mm - from_mm) / (v * period_s_) - 1e-9) * v * period_s_;
    if (!faults_.ignore_belt) moveTo(start_mm, planned_mm, layout);
    writer_.reposition(layout.park_W_mm, v_now_mm_s_);
    if (unit == 0) writer_.startFeed();
    const double belt_mm = start_mm - job_.web_start_x_mm + unit * job_.pitch_mm;
    while (!writer_.feedAtTarget() || writer_.feedMm() < belt_mm - 1e-6) writer_.hold(1);
  }

  /// Starts a unit at its print mark, a whole number of encoder counts later.
  void startAtMark(double planned_mm, UnitLayout& layout) {
    const double seen_mm = machine_.print_mark_sensor_x_mm - job_.eye_mark_x_mm;
    const long offset = std::lround((planned_mm - seen_mm) / machine_.encoder_count_mm);
    if (!faults_.ignore_belt)
      moveTo(seen_mm + static_cast<double>(offset) * machine_.encoder_count_mm, planned_mm, layout);
    writer_.reposition(layout.park_W_mm, v_now_mm_s_);
    writer_.waitMark(static_cast<std::int32_t>(offset));
    if (web_.follows) writer_.follow(true);
  }

  static void moveTo(double x_ref_mm, double planned_mm, UnitLayout& layout) {
    layout.x_ref_mm = x_ref_mm;
    layout.park_W_mm.x() += x_ref_mm - planned_mm;
  }

  Writer& writer_;
  const WebMotion& web_;
  const MachineParameters& machine_;
  const JobParameters& job_;
  const PlannerFaults& faults_;
  double period_s_;
  double v_now_mm_s_{0.0};
};

}  // namespace

Program makeProgram(const Solution& solution, const MachineParameters& machine, const JobParameters& job,
                    const PlannerFaults& faults, const Axes& axes, double belt_stop_mm_s) {
  const WebMotion web(solution, job, faults);
  Program program;
  program.config = configuration(web, machine, axes, belt_stop_mm_s);
  program.target = machine.target;
  if (job.power_loop) program.power = powerLoopPayload(machine, job, laserDelay(machine));
  Writer writer(axes, machine, job, web.v_mm_s);
  UnitWriter units(writer, web, machine, job, faults, axes.periodS());
  for (int unit = 0; unit < job.units; ++unit) program.units.push_back(units.write(solution, unit));
  units.finish();
  program.ops = writer.finish();
  return program;
}

std::string programText(const Program& program) {
  const auto hex = [](const std::vector<std::uint8_t>& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
    return text + "\n";
  };
  std::string text = "config " + hex(program.config);
  for (const auto& op : program.ops) text += hex(op);
  return text;
}

}  // namespace kerfbench::planner
