// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/strip/throughput.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {
namespace {

constexpr double kPieces[] = {1.0, 10.0, 100.0, 1000.0, 10'000.0};

/// Time until the first piece is cut, and time of each further piece.
struct Planned {
  double first_s{};
  double each_s{};
  [[nodiscard]] double of(double pieces) const { return first_s + (pieces - 1.0) * each_s; }
};

/// The unit: a cut across the strip.
std::string acrossStrip(const CrossCut& cut) {
  const double half_mm = 0.5 * cut.width_mm;
  return fmt::format("G00 X0 Y{:.4f}\nG01 X0 Y{:.4f} Z1\n", -half_mm, half_mm);
}

/// Two pieces, cut forth and back on the run.
JobParameters onTheRun(const CrossCut& cut, JobParameters job) {
  job.belt_speed_mm_s = cut.feed_mm_s;
  job.units = 2;
  job.pitch_mm = cut.piece_mm;
  job.alternate = true;
  job.stop_and_go = job.feed_by_controller = false;
  return job;
}

Planned plannedRuns(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job) {
  const double each_s = cut.piece_mm / cut.feed_mm_s;
  return {each_s + planFromGcode(acrossStrip(cut), machine, onTheRun(cut, job)).unit_time_s, each_s};
}

Planned plannedStops(const CrossCut& cut, MachineParameters machine, const JobParameters& job) {
  JobParameters stops = onTheRun(cut, job);
  stops.stop_and_go = stops.feed_by_controller = true;
  stops.web_start_x_mm = std::clamp(0.0, machine.field_min_mm[0], machine.field_max_mm[0]);
  // The table needs a feed to time, whatever drives the belt in this job.
  if (!(machine.feed_step_mm > 0.0)) machine.feed_step_mm = cut.feed_mm_s / 2e4;
  const double each_s = planFromGcode(acrossStrip(cut), machine, stops).cycle_time_s;
  return {each_s, each_s};
}

}  // namespace

Throughput throughputOf(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job) {
  if (const auto faults = cut.unusable(); !faults.empty())
    throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
  Throughput result;
  result.formula_highest_mm_s = cut.highestFeedMm_s();
  result.planned_highest_mm_s =
      maxBeltSpeed(unitOf(readGcode(acrossStrip(cut))), machine, onTheRun(cut, job), Axes(machine, {}));
  std::vector<std::string> faults = cut.faults();
  if (cut.feed_mm_s > result.planned_highest_mm_s) {
    faults.push_back(fmt::format("the feed is {:g} mm/s; with ramps {:.1f} mm/s at most can be planned",
                                 cut.feed_mm_s, result.planned_highest_mm_s));
  }
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
  const Planned stops = plannedStops(cut, machine, job);
  const Planned runs = plannedRuns(cut, machine, job);
  for (const double n : kPieces)
    result.times.push_back({n, cut.stopAndGoS(n), stops.of(n), cut.continuousS(n), runs.of(n)});
  return result;
}

std::string throughputTable(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job) {
  const Throughput result = throughputOf(cut, machine, job);
  std::string text = fmt::format(
      "pieces of {:g} mm off a strip {:g} mm wide; feed {:g}, cut {:g}, way back {:g} mm/s\n"
      "  head carried  {:.1f} of {:g} mm\n"
      "  cycle         {:.1f} of {:g} mm of strip\n"
      "by formula / with ramps, {:g} mm/s2 of the head, {:g} mm/s2 of the belt\n"
      "  highest feed  {:.1f} / {:.1f} mm/s\n"
      "time in s\n"
      "  {:>7} {:>23} {:>23} {:>6}\n",
      cut.piece_mm, cut.width_mm, cut.feed_mm_s, cut.cut_mm_s, cut.reposition_mm_s, cut.carriedMm(),
      cut.reach_mm, cut.cycleMm(), cut.piece_mm, job.acceleration_mm_s2, job.feed_acceleration_mm_s2,
      result.formula_highest_mm_s, result.planned_highest_mm_s, "pieces", "stop and go", "continuous",
      "gain");
  for (const Throughput::Times& row : result.times) {
    text += fmt::format("  {:>7} {:>11.1f} / {:>9.1f} {:>11.1f} / {:>9.1f} {:>6.2f}\n", row.pieces,
                        row.stops_s, row.planned_stops_s, row.runs_s, row.planned_runs_s,
                        row.planned_stops_s / row.planned_runs_s);
  }
  return text;
}

}  // namespace kerfbench::planner
