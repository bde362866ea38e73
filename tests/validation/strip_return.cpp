// SPDX-License-Identifier: Apache-2.0
// Constraint of S0: the lowest speed of the head's return.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/strip_record.h"
#include "tests/validation/studies.h"
#include "tests/validation/support/svg.h"

namespace kerfbench::validation {
namespace {

constexpr double kTolerance_mm = 0.05;

StripJob jobOf(double return_mm_s, double acceleration_mm_s2) {
  StripJob job;
  job.return_mm_s = return_mm_s;
  job.gantry_acceleration_mm_s2 = acceleration_mm_s2;
  return job;
}

/// Distance upstream of its line at which the second cut starts, the first one after a return.
double startError_mm(const twin::MachineDescription& machine, const StripJob& job) {
  StripLine line(machine, job, twin::Fidelity::kFast);
  line.nextPiece();
  return -line.nextPiece().near_mm;
}

/// Start error by kinematics: the strip goes on while the head is late.
double lateness_mm(const StripJob& job, double cycle_s) {
  return std::max(0.0, job.feed_mm_s * cycle_s - job.length_mm);
}

/// The return speed at which `late` ends, to 0.1 mm/s.
template <typename Late>
double limit_mm_s(const Late& late) {
  double low = 200.0;
  double high = 600.0;
  while (high - low > 0.1) {
    const double middle = 0.5 * (low + high);
    (late(middle) ? low : high) = middle;
  }
  return high;
}

struct Ramps {
  double acceleration_mm_s2{};
  double limit_mm_s{};            ///< Limit by the twin.
  double kinematic_limit_mm_s{};  ///< Limit by cycle_s().
  double worst_difference_mm{};   ///< Largest difference of start errors, twin against kinematics.
  double worst_above_mm{};        ///< Largest start error above the limit.
};

Ramps sweep(const twin::MachineDescription& machine, double acceleration_mm_s2,
            const std::vector<double>& returns_mm_s, LinePlot& plot) {
  Ramps ramps;
  ramps.acceleration_mm_s2 = acceleration_mm_s2;
  ramps.limit_mm_s = limit_mm_s(
      [&](double v0) { return startError_mm(machine, jobOf(v0, acceleration_mm_s2)) > kTolerance_mm; });
  ramps.kinematic_limit_mm_s = limit_mm_s([&](double v0) {
    const StripJob job = jobOf(v0, acceleration_mm_s2);
    return lateness_mm(job, job.cycle_s()) > kTolerance_mm;
  });
  PlotLine line{fmt::format("twin, ramps of {:g} m/s²", 1e-3 * acceleration_mm_s2), {}, true, true};
  for (const double v0 : returns_mm_s) {
    const StripJob job = jobOf(v0, acceleration_mm_s2);
    const double error_mm = startError_mm(machine, job);
    line.points.emplace_back(v0, error_mm);
    ramps.worst_difference_mm =
        std::max(ramps.worst_difference_mm, std::abs(error_mm - lateness_mm(job, job.cycle_s())));
    if (v0 > ramps.limit_mm_s) ramps.worst_above_mm = std::max(ramps.worst_above_mm, std::abs(error_mm));
  }
  plot.lines.push_back(line);
  return ramps;
}

}  // namespace

Section stripReturn(const Context& context) {
  const auto machine = stripMachine(context.source_dir);
  const bool quick = context.effort == Effort::kQuick;
  std::vector<double> returns_mm_s;
  for (double v0 = 230.0; v0 <= 400.0; v0 += quick ? 42.5 : 5.0) returns_mm_s.push_back(v0);
  const double ideal_mm_s = StripJob{}.returnLimit_mm_s();

  LinePlot plot;
  plot.title = "Start of the second cut, upstream of its line";
  plot.x.label = "return speed v_0, mm/s";
  plot.y.label = "mm";
  std::vector<Ramps> all;
  for (const double acceleration : quick ? std::vector{2500.0} : std::vector{2500.0, 8000.0, 25000.0}) {
    all.push_back(sweep(machine, acceleration, returns_mm_s, plot));
  }
  PlotLine ideal{"formula, no ramps", {}, true, false};
  for (double v0 = 230.0; v0 <= 400.0; v0 += 1.0) {
    const StripJob job = jobOf(v0, 1.0);
    ideal.points.emplace_back(v0, lateness_mm(job, job.idealCycle_s()));
  }
  plot.lines.push_back(ideal);
  plot.lines.push_back(
      {fmt::format("v_0 = {:.1f} mm/s", ideal_mm_s), {{ideal_mm_s, 0.0}, {ideal_mm_s, 120.0}}, true, false});

  Section section;
  section.title = "S0: how slowly the head may go back";
  std::vector<std::vector<std::string>> rows;
  for (const Ramps& ramps : all) {
    const std::string name = fmt::format("{:g} m/s²", 1e-3 * ramps.acceleration_mm_s2);
    rows.push_back({name, fmt::format("{:.1f}", ramps.limit_mm_s),
                    fmt::format("{:.1f}", ramps.kinematic_limit_mm_s),
                    fmt::format("{:.4f}", ramps.worst_difference_mm)});
    section.atMost(name + ": limit of the twin against kinematics with ramps, mm/s",
                   std::abs(ramps.limit_mm_s - ramps.kinematic_limit_mm_s), 0.5, "mm/s");
    section.atMost(name + ": start error, twin against kinematics", ramps.worst_difference_mm, kTolerance_mm,
                   "mm");
    section.atMost(name + ": start error above the limit", ramps.worst_above_mm, kTolerance_mm, "mm");
    section.atLeast(name + ": limit of the twin above the paper's", ramps.limit_mm_s - ideal_mm_s, 0.0,
                    "mm/s");
    section.atLeast(name + ": the cut misses its line at 270 mm/s by",
                    startError_mm(machine, jobOf(270.0, ramps.acceleration_mm_s2)), kTolerance_mm, "mm");
  }
  section.markdown =
      fmt::format(
          "(v_x/v_y)(v_x/v_0 + 1) y0 <= L asks for v_0 >= {:.1f} mm/s. Below, the head is not back when "
          "the next line comes by, and the cut starts upstream of it. Ramps and run-ups of 2 mm take "
          "their time as well; the shorter they are, the nearer the twin comes to the paper's bound. The "
          "release that does not check it is `fixtures/scenarios/faults/strip-return-slow.yaml`.\n\n",
          ideal_mm_s) +
      markdownTable({"ramps", "limit by the twin, mm/s", "by kinematics, mm/s", "start errors differ by, mm"},
                    rows);
  section.figures = {
      {"strip-return", "Where the second cut starts if the head goes back at v_0.", svgOf(plot)}};
  return section;
}

}  // namespace kerfbench::validation
