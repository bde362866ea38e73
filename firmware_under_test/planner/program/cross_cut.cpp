// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/cross_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {
namespace {

double highestByReach(const CrossCut& cut) { return cut.reach_mm * cut.cut_mm_s / cut.width_mm; }

/// Positive root of v² / v_0 + v = L v_y / y0.
double highestByPiece(const CrossCut& cut) {
  const double v0 = cut.reposition_mm_s;
  return 0.5 * v0 * (std::sqrt(1.0 + 4.0 * cut.piece_mm * cut.cut_mm_s / (cut.width_mm * v0)) - 1.0);
}

/// Time until the first piece is cut, and time of each further piece.
struct Planned {
  double first_s{};
  double each_s{};
};

Planned planned(const CrossCut& cut, const MachineParameters& machine, JobParameters job, bool stop_and_go) {
  job.belt_speed_mm_s = cut.feed_mm_s;
  job.units = 2;
  job.pitch_mm = cut.piece_mm;
  job.alternate = true;
  job.stop_and_go = job.feed_by_controller = stop_and_go;
  MachineParameters with_feed = machine;
  if (stop_and_go) {
    job.web_start_x_mm = std::clamp(0.0, machine.field_min_mm[0], machine.field_max_mm[0]);
    // The table needs a feed to time, whatever drives the belt in this job.
    if (!(with_feed.feed_step_mm > 0.0)) with_feed.feed_step_mm = cut.feed_mm_s / 2e4;
  }
  const double half_mm = 0.5 * cut.width_mm;
  const Plan plan =
      planFromGcode(fmt::format("G00 X0 Y{:.4f}\nG01 X0 Y{:.4f} Z1\n", -half_mm, half_mm), with_feed, job);
  if (stop_and_go) return {plan.cycle_time_s, plan.cycle_time_s};
  return {cut.piece_mm / cut.feed_mm_s + plan.unit_time_s, cut.piece_mm / cut.feed_mm_s};
}

}  // namespace

double CrossCut::carriedMm() const { return feed_mm_s * width_mm / cut_mm_s; }

double CrossCut::cycleMm() const { return carriedMm() * (feed_mm_s / reposition_mm_s + 1.0); }

double CrossCut::highestFeedMm_s() const { return std::min(highestByReach(*this), highestByPiece(*this)); }

std::vector<std::string> CrossCut::faults() const {
  std::vector<std::string> faults;
  const std::pair<const char*, double> values[] = {
      {"length of a piece", piece_mm}, {"width of the strip", width_mm},
      {"reach of the head", reach_mm}, {"feed", feed_mm_s},
      {"speed of the cut", cut_mm_s},  {"speed of the way back", reposition_mm_s}};
  for (const auto& [name, value] : values) {
    if (!(std::isfinite(value) && value > 0.0))
      faults.push_back(fmt::format("the {} must be > 0, but is {:g}", name, value));
  }
  if (!faults.empty()) return faults;
  constexpr double kRounding = 1.0 + 1e-9;
  if (carriedMm() > reach_mm * kRounding) {
    faults.push_back(
        fmt::format("the strip carries the head {:.1f} mm while it cuts {:g} mm at {:g} mm/s (v_x y0 / v_y), "
                    "its reach is "
                    "{:g} mm: {:.1f} mm/s at most",
                    carriedMm(), width_mm, cut_mm_s, reach_mm, highestByReach(*this)));
  }
  if (cycleMm() > piece_mm * kRounding) {
    faults.push_back(
        fmt::format("{:.1f} mm of strip pass during a cut and the way back at {:g} mm/s ((v_x / v_y)(v_x / "
                    "v_0 + 1) y0), a "
                    "piece has {:g} mm: {:.1f} mm/s at most",
                    cycleMm(), reposition_mm_s, piece_mm, highestByPiece(*this)));
  }
  return faults;
}

double CrossCut::stopAndGoS(double pieces) const {
  return pieces * (piece_mm / feed_mm_s + width_mm / cut_mm_s);
}

double CrossCut::continuousS(double pieces) const {
  return pieces * piece_mm / feed_mm_s + width_mm / cut_mm_s;
}

std::optional<CrossCut> crossCutOf(const std::vector<Segment>& path, const MachineParameters& machine,
                                   const JobParameters& job) {
  if (path.size() != 1 || path.front().isArc() || job.stop_and_go || job.units < 2) return std::nullopt;
  const Eigen::Vector2d line = path.front().end_mm - path.front().start_mm;
  if (!(job.belt_speed_mm_s > 0.0) || std::abs(line.x()) > 0.01 * std::abs(line.y())) return std::nullopt;
  return CrossCut{job.pitch_mm,        std::abs(line.y()),  machine.field_max_mm[0] - machine.field_min_mm[0],
                  job.belt_speed_mm_s, job.mark_speed_mm_s, job.jump_speed_mm_s};
}

std::string throughputTable(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job) {
  const std::vector<std::string> faults = cut.faults();
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
  const Planned stops = planned(cut, machine, job, true);
  const Planned runs = planned(cut, machine, job, false);
  std::string text = fmt::format(
      "pieces of {:g} mm off a strip {:g} mm wide; feed {:g}, cut {:g}, way back {:g} mm/s\n"
      "  head carried  {:.1f} of {:g} mm\n"
      "  cycle         {:.1f} of {:g} mm of strip\n"
      "  highest feed  {:.1f} mm/s\n"
      "time in s, by formula / with ramps, {:g} mm/s2 of the head, {:g} mm/s2 of the belt\n"
      "  {:>7} {:>23} {:>23} {:>6}\n",
      cut.piece_mm, cut.width_mm, cut.feed_mm_s, cut.cut_mm_s, cut.reposition_mm_s, cut.carriedMm(),
      cut.reach_mm, cut.cycleMm(), cut.piece_mm, cut.highestFeedMm_s(), job.acceleration_mm_s2,
      job.feed_acceleration_mm_s2, "pieces", "stop and go", "continuous", "gain");
  for (const double n : {1.0, 100.0, 1000.0, 10000.0}) {
    const double stop_s = stops.first_s + (n - 1.0) * stops.each_s;
    const double run_s = runs.first_s + (n - 1.0) * runs.each_s;
    text += fmt::format("  {:>7} {:>11.1f} / {:>9.1f} {:>11.1f} / {:>9.1f} {:>6.2f}\n", n, cut.stopAndGoS(n),
                        stop_s, cut.continuousS(n), run_s, stop_s / run_s);
  }
  return text;
}

}  // namespace kerfbench::planner
