// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/unit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/geometry/jump_curve.h"
#include "firmware_under_test/planner/motion/jerk_profile.h"
#include "firmware_under_test/planner/motion/rounding.h"
#include "firmware_under_test/planner/motion/run_up.h"
#include "firmware_under_test/planner/motion/runs.h"
#include "firmware_under_test/planner/motion/speed.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

void addSamples(std::span<const Segment> run, const std::vector<double>& stations,
                std::vector<Sample>& samples) {
  std::size_t segment = 0;
  double begun_mm = 0.0;
  double length_mm = run[0].lengthMm();
  for (std::size_t k = 1; k < stations.size(); ++k) {
    while (segment + 1 < run.size() && stations[k] > begun_mm + length_mm) {
      begun_mm += length_mm;
      length_mm = run[++segment].lengthMm();
    }
    const double marked_mm = run[0].z * (stations[k] - stations[k - 1]);
    samples.push_back({run[segment].at(stations[k] - begun_mm), marked_mm, run[segment].line, run[0].z});
  }
  samples.back().p_S_mm = run.back().end_mm;
}

/// Stations of each run from rest to rest.
std::vector<std::vector<double>> restStations(const std::vector<Run>& runs, const FlowLimits& limits) {
  std::vector<std::vector<double>> stations;
  for (const Run& run : runs)
    stations.push_back(planRun(run.segments, speedLimitsOf(limits, run.segments.front().jump)));
  return stations;
}

std::vector<std::vector<double>> flowStations(const std::vector<Run>& runs, const FlowLimits& limits) {
  std::vector<std::vector<Segment>> paths;
  std::vector<bool> rests;
  for (const Run& run : runs) {
    paths.push_back(run.segments);
    rests.push_back(run.rests);
  }
  return planFlow(paths, rests, limits);
}

double radiusFor(const std::vector<Segment>& path, const JobParameters& job) {
  if (job.jump_radius_mm != kRadiusOfDrawing) return job.jump_radius_mm;
  Eigen::AlignedBox2d box;
  for (const Segment& segment : path) {
    if (segment.jump) continue;
    constexpr int kParts = 16;
    for (int i = 0; i <= kParts; ++i) box.extend(segment.at(segment.lengthMm() * i / kParts));
  }
  return paperRadiusMm(box.sizes().maxCoeff());
}

/// Field as the sheet sees it: where all units of a resting one can be reached; without ends along a moving
/// one.
std::pair<Vector2d, Vector2d> fieldOnSheet(const JobParameters& job, const Axes& axes,
                                           double belt_speed_mm_s) {
  Vector2d low = axes.fieldMinMm();
  Vector2d high = axes.fieldMaxMm();
  if (belt_speed_mm_s > 0.0) {
    low.x() = -1e12;
    high.x() = 1e12;
    return {low, high};
  }
  const double last_mm = job.stop_and_go ? 0.0 : (job.units - 1) * job.pitch_mm;
  low.x() -= job.web_start_x_mm - last_mm;
  high.x() -= job.web_start_x_mm;
  return {low, high};
}

void setExtremes(Block& block, const Vector2d& start_S_mm, double belt_speed_mm_s, double period_s) {
  block.low_mm = block.high_mm = start_S_mm.x();
  double t_s = 0.0;
  for (const Sample& sample : block.samples) {
    t_s += period_s;
    const double x = sample.p_S_mm.x() + belt_speed_mm_s * t_s;
    block.low_mm = std::min(block.low_mm, x);
    block.high_mm = std::max(block.high_mm, x);
  }
}

std::string nameOf(const Block& block) {
  return block.entity >= 0 ? fmt::format("E{}", block.entity) : fmt::format("G-code line {}", block.line);
}

/// One greedy pass from beta_1 at the first block, where beta is x_W - x_S. Empty if a block meets the end of
/// the field.
struct Pass {
  std::vector<int> waits;
  std::size_t stuck{};  ///< First block that does not fit; blocks.size() if all do.
};

class Layouter {
 public:
  Layouter(const UnitPath& unit, double low_mm, double high_mm)
      : unit_(unit), low_mm_(low_mm), high_mm_(high_mm), step_mm_(unit.belt_speed_mm_s * unit.period_s) {}

  Pass from(double beta_mm) const {
    Pass pass;
    const auto& blocks = unit_.blocks;
    for (pass.stuck = 0; pass.stuck < blocks.size(); ++pass.stuck) {
      const Block& block = blocks[pass.stuck];
      const double lack_mm = low_mm_ - block.low_mm - beta_mm;
      int wait = 0;
      if (pass.stuck > 0 && lack_mm > 0.0) wait = static_cast<int>(std::ceil(lack_mm / step_mm_));
      beta_mm += wait * step_mm_;
      if (beta_mm + block.high_mm > high_mm_ + 1e-9) return pass;
      pass.waits.push_back(wait);
      beta_mm += static_cast<double>(block.samples.size()) * step_mm_;
    }
    return pass;
  }

  /// Window of beta_1 in which no wait is needed; empty if first > second.
  std::pair<double, double> withoutWaits() const {
    double from = -std::numeric_limits<double>::infinity();
    double to = std::numeric_limits<double>::infinity();
    double run_mm = 0.0;
    for (const Block& block : unit_.blocks) {
      from = std::max(from, low_mm_ - block.low_mm - run_mm);
      to = std::min(to, high_mm_ - block.high_mm - run_mm);
      run_mm += static_cast<double>(block.samples.size()) * step_mm_;
    }
    return {from, to};
  }

  /// Latest beta_1 that leaves no block behind.
  double latest() const {
    double beta = std::numeric_limits<double>::infinity();
    for (auto it = unit_.blocks.rbegin(); it != unit_.blocks.rend(); ++it) {
      beta = std::min(high_mm_ - it->high_mm, beta - static_cast<double>(it->samples.size()) * step_mm_);
    }
    return beta;
  }

 private:
  const UnitPath& unit_;
  double low_mm_, high_mm_, step_mm_;
};

LayoutResult layOutResting(const UnitPath& unit, const MachineParameters& machine, double x_ref_mm) {
  UnitLayout layout;
  layout.x_ref_mm = x_ref_mm;
  layout.waits.assign(unit.blocks.size(), 0);
  std::string reason;
  std::set<std::string> named;
  for (const Block& block : unit.blocks) {
    layout.sheet_periods += static_cast<int>(block.samples.size());
    const double low = block.low_mm + x_ref_mm;
    const double high = block.high_mm + x_ref_mm;
    const bool inside = low >= machine.field_min_mm[0] - 1e-9 && high <= machine.field_max_mm[0] + 1e-9;
    if (inside || !named.insert(nameOf(block)).second) continue;
    reason +=
        fmt::format("{}from {}: x_W {:.3f} … {:.3f} mm, the field {:g} … {:g} mm", reason.empty() ? "" : "\n",
                    nameOf(block), low, high, machine.field_min_mm[0], machine.field_max_mm[0]);
  }
  const Vector2d shift(x_ref_mm, 0.0);
  layout.park_W_mm = unit.start_S_mm + shift;
  layout.end_W_mm = unit.endS() + shift;
  if (!reason.empty()) return {std::nullopt, reason};
  return {layout, {}};
}

}  // namespace

int catchUpPeriods(double belt_speed_mm_s, double acceleration_mm_s2, double period_s) {
  return static_cast<int>(std::ceil(1.5 * belt_speed_mm_s / acceleration_mm_s2 / period_s - 1e-9));
}

double catchUpMm(double u, double belt_speed_mm_s, int periods, double period_s) {
  return belt_speed_mm_s * periods * period_s * u * u * u * (1.0 - 0.5 * u);
}

std::optional<UnitPath> planUnit(const std::vector<Segment>& path, const JobParameters& job, const Axes& axes,
                                 double belt_speed_mm_s, const std::vector<bool>& stops, bool soonest) {
  const double top_mm_s =
      std::min(std::max(job.mark_speed_mm_s, job.jump_speed_mm_s), axes.axisLimits().norm()) +
      belt_speed_mm_s;
  const auto [low_mm, high_mm] = fieldOnSheet(job, axes, belt_speed_mm_s);
  const FlowLimits limits{
      job.mark_speed_mm_s,
      job.jump_speed_mm_s,
      job.acceleration_mm_s2,
      jumpAcceleration(job),
      axes.accelerationBox(top_mm_s),
      low_mm,
      high_mm,
      axes.periodS(),
      [&](const Vector2d& direction) { return axes.speedLimit(direction, belt_speed_mm_s); },
      job.jerk_mm_s3,
      {job.corner_error_mm, axes.trackingDelayS()}};
  if (limits.box_mm_s2.minCoeff() <= 0.0) return std::nullopt;
  const bool smooth = job.jump_radius_mm != 0.0;
  const std::vector<Segment> rounded = roundedCorners(path, limits);
  UnitPath unit;
  std::vector<Run> runs =
      smooth ? smoothRuns(rounded, {radiusFor(path, job), stops, soonest}, limits, unit.jumps)
             : straightRuns(rounded);
  const bool runs_up = job.run_up_mm != 0.0;
  if (runs_up) addRunUps(runs, job.run_up_mm == kRunUpOfSpeed ? runUpMm(limits) : job.run_up_mm);
  const std::vector<std::vector<double>> stations =
      smooth || runs_up ? flowStations(runs, limits) : restStations(runs, limits);
  unit.start_S_mm = runs.front().segments.front().start_mm;
  unit.belt_speed_mm_s = belt_speed_mm_s;
  unit.period_s = axes.periodS();
  unit.acceleration_mm_s2 = std::min(job.acceleration_mm_s2, limits.box_mm_s2.x());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (stations.size() <= i || stations[i].empty()) return std::nullopt;
    const Segment& first = runs[i].segments.front();
    if (runs[i].begins_block) unit.blocks.emplace_back();
    if (first.jump || first.z == 0.0) unit.jump_length_mm += stations[i].back();
    Block& block = unit.blocks.back();
    if (!first.jump && block.line == 0) {
      block.entity = first.entity;
      block.line = first.line;
    }
    addSamples(runs[i].segments, stations[i], block.samples);
  }
  Vector2d start = unit.start_S_mm;
  for (Block& block : unit.blocks) {
    setExtremes(block, start, belt_speed_mm_s, unit.period_s);
    start = block.samples.back().p_S_mm;
  }
  return unit;
}

LayoutResult layOut(const UnitPath& unit, const MachineParameters& machine, const StartBounds& bounds) {
  if (bounds.fixed_x_ref_mm) return layOutResting(unit, machine, *bounds.fixed_x_ref_mm);
  const double v = unit.belt_speed_mm_s;
  UnitLayout layout;
  layout.catch_up_periods = catchUpPeriods(v, unit.acceleration_mm_s2, unit.period_s);
  // Travel of the belt; the beam makes half of it.
  const double catch_up_mm = v * layout.catch_up_periods * unit.period_s;
  const double lead_mm = v * machine.tracking_delay_s;
  const double low_mm = machine.field_min_mm[0] + machine.encoder_count_mm;
  const double high_mm = machine.field_max_mm[0] - bounds.play_mm;
  const double first_mm = unit.start_S_mm.x();
  const double earliest =
      std::max({low_mm - unit.blocks.front().low_mm, low_mm - first_mm + 0.5 * catch_up_mm,
                bounds.min_x_ref_mm + machine.encoder_count_mm + catch_up_mm + lead_mm});
  const Layouter layouter(unit, low_mm, high_mm);
  double beta = earliest;
  const auto [from, to] = layouter.withoutWaits();
  if (std::max(from, earliest) <= to) {
    beta = 0.5 * (std::max(from, earliest) + to);
  } else {
    const Pass pass = layouter.from(earliest);
    if (pass.stuck < unit.blocks.size()) {
      return {std::nullopt,
              fmt::format("{} leaves the field (x_W {:g} … {:g} mm) before it is done",
                          nameOf(unit.blocks[pass.stuck]), machine.field_min_mm[0], machine.field_max_mm[0])};
    }
    const double latest = layouter.latest();
    for (const double share : {1.0, 0.98, 0.9, 0.75, 0.5, 0.25}) {
      const double candidate = earliest + share * (latest - earliest);
      if (layouter.from(candidate).stuck == unit.blocks.size()) {
        beta = candidate;
        break;
      }
    }
  }
  layout.waits = layouter.from(beta).waits;
  for (std::size_t i = 0; i < unit.blocks.size(); ++i) {
    layout.sheet_periods += layout.waits[i] + static_cast<int>(unit.blocks[i].samples.size());
  }
  layout.x_ref_mm = beta - catch_up_mm - lead_mm;
  layout.park_W_mm = unit.start_S_mm + Vector2d(beta - 0.5 * catch_up_mm, 0.0);
  layout.end_W_mm = unit.endS() + Vector2d(beta + v * layout.sheet_periods * unit.period_s, 0.0);
  return {layout, {}};
}

}  // namespace kerfbench::planner
