// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/solve.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Shares of the path's limits for x and y, in proportion to the distances. An axis that moves at all gets
/// enough to brake the speed of the belt.
Vector2d sharesOf(const Vector2d& move_mm) {
  constexpr double kLeast = 0.3;
  const double length = move_mm.norm();
  if (length < 1e-9 || std::abs(move_mm.y()) < 1e-9) return {1.0, 1.0};
  const Vector2d raised = (move_mm.cwiseAbs() / length).cwiseMax(kLeast);
  return raised / raised.norm();
}

AxisMove axisMove(int axis, const Vector2d& p0, double v0, const Vector2d& p1, const JobParameters& job,
                  const Axes& axes) {
  const double share = sharesOf(p1 - p0)[axis];
  const double speed = std::min(job.jump_speed_mm_s * share, axes.axisLimits()[axis]);
  const double mirror = axes.accelerationBox(axes.axisLimits().cwiseMin(job.jump_speed_mm_s).norm())[axis];
  return {p0[axis], v0, p1[axis], speed, std::min(jumpAcceleration(job) * share, mirror)};
}

/// Describes too many waiting marks. The controller keeps the marks that have passed the sensor and whose
/// units have not begun; it holds only a limited number.
std::optional<std::string> marksFault(const UnitLayout& layout, const MachineParameters& machine,
                                      const JobParameters& job) {
  const double behind_mm = layout.x_ref_mm - (machine.print_mark_sensor_x_mm - job.eye_mark_x_mm);
  const int waiting = std::min(job.units, 1 + static_cast<int>(behind_mm / job.pitch_mm));
  if (waiting < KB_MARKS_MAX) return std::nullopt;
  return fmt::format(
      "{} print marks would wait between sensor and start, {:.3f} mm apart; the controller holds {}", waiting,
      behind_mm, KB_MARKS_MAX - 1);
}

std::optional<std::string> pitchFault(const Solution& solution, int unit, const JobParameters& job,
                                      const Axes& axes) {
  const double v = solution.belt_speed_mm_s;
  const UnitLayout& now = solution.layoutOf(unit);
  const UnitLayout& next = solution.layoutOf(unit + 1);
  const Reposition back(now.end_W_mm, v, next.park_W_mm, job, axes);
  const int cycle = now.catch_up_periods + now.sheet_periods + back.periods() + kSparePeriods;
  const double between_s = (job.pitch_mm + next.x_ref_mm - now.x_ref_mm) / v;
  if (cycle * axes.periodS() <= between_s) return std::nullopt;
  return fmt::format(
      "the pitch of {:g} mm brings the next unit after {:.4f} s, but a unit with the way back takes "
      "{:.4f} s",
      job.pitch_mm, between_s, cycle * axes.periodS());
}

/// Plans one path, or two if the job alternates; empty if the belt is too fast for the axes.
std::vector<UnitPath> planPaths(const std::vector<Segment>& path, const JobParameters& job, const Axes& axes,
                                double belt_speed_mm_s, const std::vector<std::vector<bool>>& stops,
                                bool soonest) {
  std::vector<UnitPath> paths;
  const std::size_t count = job.alternate && job.units > 1 ? 2 : 1;
  for (std::size_t i = 0; i < count; ++i) {
    auto unit = planUnit(i > 0 ? reversedPath(path) : path, job, axes, belt_speed_mm_s,
                         i < stops.size() ? stops[i] : std::vector<bool>{}, soonest);
    if (!unit) return {};
    paths.push_back(std::move(*unit));
  }
  return paths;
}

/// Places the units in field and pitch.
SolveResult layOutAll(std::vector<UnitPath> paths, const MachineParameters& machine, const JobParameters& job,
                      const Axes& axes) {
  Solution solution;
  solution.paths = std::move(paths);
  const double v = solution.paths.front().belt_speed_mm_s;
  solution.belt_speed_mm_s = v;
  if (v <= 0.0) {
    for (int k = 0; k < job.units; ++k) {
      LayoutResult result = layOut(solution.pathOf(k), machine,
                                   {job.web_start_x_mm - (job.stop_and_go ? 0 : k) * job.pitch_mm, 0.0, 0.0});
      if (!result.layout) return {std::nullopt, result.reason};
      solution.layouts.push_back(std::move(*result.layout));
    }
    return {std::move(solution), {}};
  }
  StartBounds bounds;
  if (job.feed_by_controller) {
    if (v > feedLimit(machine)) {
      return {std::nullopt, fmt::format("the feed makes no more than {:.1f} mm/s", feedLimit(machine))};
    }
    bounds.min_x_ref_mm = job.web_start_x_mm + feedRampMm(v, job, axes.periodS());
    bounds.play_mm = v * axes.periodS();
  } else {
    bounds.min_x_ref_mm = machine.print_mark_sensor_x_mm - job.eye_mark_x_mm;
    bounds.play_mm = machine.encoder_count_mm;
  }
  for (const UnitPath& unit : solution.paths) {
    LayoutResult result = layOut(unit, machine, bounds);
    if (!result.layout) return {std::nullopt, result.reason};
    solution.layouts.push_back(std::move(*result.layout));
  }
  std::string reasons;
  const auto refuse = [&](const std::string& reason) {
    if (reasons.find(reason) == std::string::npos) reasons += (reasons.empty() ? "" : "; ") + reason;
  };
  for (const UnitLayout& layout : solution.layouts) {
    if (job.feed_by_controller || job.units < 2) break;
    if (auto fault = marksFault(layout, machine, job)) refuse(*fault);
  }
  for (int k = 0; k + 1 < job.units && k < 2; ++k) {
    if (axes.faults().return_unchecked) break;
    if (auto fault = pitchFault(solution, k, job, axes)) refuse(*fault);
  }
  if (!reasons.empty()) return {std::nullopt, reasons};
  return {std::move(solution), {}};
}

/// Jumps before which each of the layouts waits.
std::vector<std::vector<bool>> waitsOf(const Solution& solution) {
  std::vector<std::vector<bool>> stops;
  for (const UnitLayout& layout : solution.layouts) {
    std::vector<bool>& waits = stops.emplace_back();
    for (std::size_t i = 1; i < layout.waits.size(); ++i) waits.push_back(layout.waits[i] > 0);
  }
  return stops;
}

JumpsTaken allStraight(const std::vector<Segment>& path) {
  JumpsTaken taken;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (path[i - 1].jump && !path[i].jump)
      taken.straight.push_back({path[i].entity, path[i].line, JumpsTaken::Why::kNoRoom});
  }
  return taken;
}

}  // namespace

Reposition::Reposition(const Vector2d& p0_W_mm, double v0_mm_s, const Vector2d& p1_W_mm,
                       const JobParameters& job, const Axes& axes)
    : x_(axisMove(0, p0_W_mm, v0_mm_s, p1_W_mm, job, axes)),
      y_(axisMove(1, p0_W_mm, 0.0, p1_W_mm, job, axes)),
      period_s_(axes.periodS()) {}

int Reposition::periods() const {
  return static_cast<int>(std::ceil(std::max(x_.durationS(), y_.durationS()) / period_s_ - 1e-9));
}

Vector2d Reposition::at(int period) const { return {x_.at(period * period_s_), y_.at(period * period_s_)}; }

int feedRampPeriods(double belt_speed_mm_s, const JobParameters& job, double period_s) {
  return static_cast<int>(std::ceil(belt_speed_mm_s / job.feed_acceleration_mm_s2 / period_s - 1e-9));
}

double feedLimit(const MachineParameters& machine) {
  const int most = pulsesFor(machine.target, machine.drives).most_steps[KB_FEED];
  return Target::stepBudget(most) * machine.feed_step_mm / machine.target.periodS();
}

AxisMove feedOfPitch(const JobParameters& job) {
  return {0.0, 0.0, job.pitch_mm, job.belt_speed_mm_s, job.feed_acceleration_mm_s2};
}

int feedOfPitchPeriods(const JobParameters& job, double period_s) {
  return static_cast<int>(std::ceil(feedOfPitch(job).durationS() / period_s - 1e-9));
}

double feedRampMm(double belt_speed_mm_s, const JobParameters& job, double period_s) {
  return 0.5 * belt_speed_mm_s * feedRampPeriods(belt_speed_mm_s, job, period_s) * period_s;
}

SolveResult solve(const std::vector<Segment>& path, const MachineParameters& machine,
                  const JobParameters& job, const Axes& axes, double belt_speed_mm_s) {
  const auto with = [&](const JobParameters& tried, const std::vector<std::vector<bool>>& stops,
                        bool soonest) -> SolveResult {
    std::vector<UnitPath> paths = planPaths(path, tried, axes, belt_speed_mm_s, stops, soonest);
    if (!paths.empty()) return layOutAll(std::move(paths), machine, tried, axes);
    return {std::nullopt, fmt::format("the x axis makes no more than {:.1f} mm/s", axes.axisLimits().x())};
  };
  SolveResult result = with(job, {}, false);
  if (result.solution || job.jump_radius_mm == 0.0) return result;
  // A moving beam cannot wait for the sheet: it rests where the straight jumps have to wait.
  JobParameters straight = job;
  straight.jump_radius_mm = 0.0;
  SolveResult held = with(straight, {}, false);
  if (held.solution) {
    const std::vector<std::vector<bool>> stops = waitsOf(*held.solution);
    for (const bool soonest : {false, true}) {
      SolveResult mixed = with(job, stops, soonest);
      if (mixed.solution) return mixed;
    }
    for (UnitPath& unit : held.solution->paths) unit.jumps = allStraight(path);
    return held;
  }
  // Nothing waits, so it is time that lacks.
  if (belt_speed_mm_s <= 0.0) return held;
  SolveResult sooner = with(job, {}, true);
  return sooner.solution ? std::move(sooner) : std::move(held);
}

double maxBeltSpeed(const std::vector<Segment>& path, const MachineParameters& machine,
                    const JobParameters& job, const Axes& axes) {
  const auto feasible = [&](double v) { return solve(path, machine, job, axes, v).solution.has_value(); };
  // The search goes upwards, so that the answer does not lie beyond a gap: more speed need not always be
  // worse, as a wait may vanish.
  constexpr int kTries = 24;
  const double top = axes.axisLimits().x();
  const double ratio = std::pow(1000.0, 1.0 / kTries);
  double good = 0.0;
  double bad = top;
  for (int i = 0; i <= kTries; ++i) {
    const double v = top / 1000.0 * std::pow(ratio, i);
    if (!feasible(v)) {
      bad = v;
      break;
    }
    good = v;
  }
  if (good == 0.0) return 0.0;
  while (bad - good > 0.0005 * good) {
    const double middle = 0.5 * (good + bad);
    (feasible(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace kerfbench::planner
