// SPDX-License-Identifier: Apache-2.0
// Mirrors by steppers with subdivision drives, as in S4, which states ±0.05 mm: where this holds.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/machine_file/machine_file.h"
#include "tests/validation/studies.h"
#include "tests/validation/support/machine_run.h"
#include "tests/validation/support/svg.h"

namespace kerfbench::validation {
namespace {

using Eigen::Vector2d;

constexpr double kLimit_mm = 0.05;
constexpr double kMirrorRadius_mm = 10.0;
constexpr double kRunUp_mm = 5.0;  // Length from rest to the mark's speed.

struct Variant {
  std::string name, says;
  bool detent{};
  double ratio{1.0};  ///< Ratio of the mirror over the motor.
};

twin::MachineDescription built(const twin::MachineDescription& as_shipped, const Variant& variant,
                               int subdivision) {
  twin::MachineDescription machine = as_shipped;
  for (twin::AxisDescription* axis : {&machine.galvo_x, &machine.galvo_y}) {
    auto& stepper = std::get<twin::StepperDescription>(axis->drive);
    if (!variant.detent) stepper.detent_torque_nm = 0.0;
    axis->load_per_motor = variant.ratio;
    axis->step = variant.ratio * 2.0 * std::numbers::pi / (4.0 * stepper.rotor_teeth * subdivision);
  }
  return machine;
}

Speeds restToRest(double speed_mm_s) {
  return {0.0, speed_mm_s, 0.0, std::max(1000.0, speed_mm_s * speed_mm_s / (2.0 * kRunUp_mm))};
}

Motion lineOf(const Vector2d& from, const Vector2d& to, double speed_mm_s) {
  Motion motion(from);
  motion.line(to, restToRest(speed_mm_s), true);
  return motion;
}

// Lines along, across and slanting, and a circle, in the field's middle.
std::vector<Motion> marks(double speed_mm_s) {
  std::vector<Motion> result{lineOf({-15.0, 3.3}, {15.0, 3.3}, speed_mm_s),
                             lineOf({2.7, -15.0}, {2.7, 15.0}, speed_mm_s),
                             lineOf({-12.0, -5.1}, {13.0, 9.3}, speed_mm_s)};
  Motion circle({kMirrorRadius_mm, 0.0});
  circle.arc(Vector2d::Zero(), 2.0 * std::numbers::pi, restToRest(speed_mm_s), true);
  result.push_back(circle);
  return result;
}

struct Worst {
  double deviation_mm{};
  bool lost{};
};

Worst worstOf(const twin::MachineDescription& machine, double speed_mm_s) {
  constexpr double kTail_s = 20e-3;  // The laser stays on until the mirrors are calm.
  Worst worst;
  for (const Motion& mark : marks(speed_mm_s)) {
    const auto run = runMachine(machine, restingWeb(), mark, kTail_s, twin::Fidelity::kFast);
    for (const Vector2d& spot : run.spot_mm) {
      raiseTo(worst.deviation_mm, mark.distance_mm(spot));
    }
    worst.lost = worst.lost || !run.lost.empty();
  }
  return worst;
}

struct Map {
  CellPlot plot;
  double best_mm{INFINITY};
  double slow_fine_mm{};  ///< Error at the slowest speed and the finest subdivision.
  int holds{}, losses{}, cells{};
  std::string where;  ///< Fastest cell that holds.
};

Map mapOf(const twin::MachineDescription& as_shipped, const Variant& variant,
          const std::vector<int>& subdivisions, const std::vector<double>& speeds_mm_s) {
  Map map;
  map.plot = {variant.says + ": deviation of the lit path, mm (* lost steps)",
              "mark speed, mm/s",
              "subdivision",
              {},
              {},
              {},
              {},
              kLimit_mm};
  for (const double speed : speeds_mm_s) map.plot.columns.push_back(fmt::format("{:g}", speed));
  double fastest_mm_s = 0.0;
  for (const int subdivision : subdivisions) {
    const auto machine = built(as_shipped, variant, subdivision);
    const double pulse_mm =
        2.0 * machine.galvo_x.step * (machine.head.throw_mm + machine.head.mirror_spacing_mm);
    map.plot.rows.push_back(fmt::format("{} ({:.3f})", subdivision, pulse_mm));
    map.plot.value.emplace_back();
    map.plot.text.emplace_back();
    for (const double speed : speeds_mm_s) {
      const Worst worst = worstOf(machine, speed);
      const double shown = worst.lost ? std::max(worst.deviation_mm, 100.0 * kLimit_mm) : worst.deviation_mm;
      map.plot.value.back().push_back(shown);
      map.plot.text.back().push_back(fmt::format("{:.3f}{}", worst.deviation_mm, worst.lost ? "*" : ""));
      if (speed == speeds_mm_s.front()) map.slow_fine_mm = worst.deviation_mm;
      ++map.cells;
      map.losses += worst.lost ? 1 : 0;
      map.best_mm = std::min(map.best_mm, shown);
      if (shown > kLimit_mm) continue;
      ++map.holds;
      if (speed > fastest_mm_s) {
        fastest_mm_s = speed;
        map.where = fmt::format("up to {:g} mm/s, there from subdivision {}", speed, subdivision);
      }
    }
  }
  if (map.where.empty()) map.where = "nowhere";
  return map;
}

// Figure of the worst mark's error behind a reduction, at 16 microsteps and one speed.
Figure overReduction(const twin::MachineDescription& as_shipped, bool quick) {
  constexpr int kSubdivision = 16;
  LinePlot plot{fmt::format("With detent, {} microsteps, behind a reduction", kSubdivision),
                {"motor turns for one of the mirror", true},
                {"deviation of the lit path, mm", true},
                {},
                {{kLimit_mm, "0.05 mm"}}};
  for (const double speed_mm_s : {50.0, 200.0, 800.0}) {
    PlotLine line{fmt::format("{:g} mm/s", speed_mm_s), {}, true, true};
    for (const double reduction :
         quick ? std::vector{1.0, 30.0} : std::vector{1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 50.0}) {
      const auto machine = built(as_shipped, {"", "", true, 1.0 / reduction}, kSubdivision);
      line.points.emplace_back(reduction, worstOf(machine, speed_mm_s).deviation_mm);
    }
    plot.lines.push_back(std::move(line));
  }
  return {"stepper-reduction", plot.title, svgOf(plot)};
}

// Largest error of a motor at rest: the detent pulls it until the field, a spring of T_h N, holds it.
double detentError_mm(const twin::MachineDescription& machine) {
  const auto& stepper = std::get<twin::StepperDescription>(machine.galvo_x.drive);
  const double off_rad = stepper.detent_torque_nm / (stepper.holding_torque_nm * stepper.rotor_teeth);
  return 2.0 * off_rad *
         std::hypot(machine.head.throw_mm + machine.head.mirror_spacing_mm, machine.head.throw_mm);
}

// Largest error of rounding to pulses, swing included: half a pulse, and the sawtooth's first harmonic pulse
// / pi at the worst of all pulse rates, amplified by the resonance's 1 / (2 zeta), in both axes.
double roundingError_mm(const twin::MachineDescription& machine, double pulse_mm) {
  const auto& stepper = std::get<twin::StepperDescription>(machine.galvo_x.drive);
  const double inertia = machine.galvo_x.motor_inertia_kg_m2 + machine.galvo_x.load_inertia;
  const double field = stepper.holding_torque_nm * stepper.rotor_teeth;
  const double zeta = stepper.damping_nm_s / (2.0 * std::sqrt(field * inertia));
  return std::numbers::sqrt2 * pulse_mm * (0.5 + 1.0 / (2.0 * zeta * std::numbers::pi));
}

std::string verdict(const std::vector<Map>& maps) {
  const auto word = [](const Map& map) { return map.holds > 0 ? "holds " + map.where : "holds nowhere"; };
  return fmt::format(
      "S4's ±0.05 mm {} with this motor on the mirror's own shaft: the detent holds the rotor off its "
      "microstep, and no\nsubdivision helps against that. Without detent it {}; behind a reduction of 20, "
      "detent "
      "and all, it {}.\n\n",
      word(maps[0]), word(maps[1]), word(maps[2]));
}

}  // namespace

Section mirrorStepper(const Context& context) {
  const bool quick = context.effort == Effort::kQuick;
  const auto as_shipped =
      machine_file::readMachine(context.source_dir / "fixtures/machines/two-mirror-stepper.yaml");
  const std::vector<int> subdivisions = quick ? std::vector{16, 512} : std::vector{16, 32, 64, 128, 256, 512};
  const std::vector<double> speeds_mm_s =
      quick ? std::vector{50.0} : std::vector{10.0, 50.0, 100.0, 200.0, 400.0, 800.0, 1600.0, 3200.0};
  const std::vector<Variant> variants{
      {"stepper-as-built", "motor on the mirror's shaft, as `two-mirror-stepper.yaml`", true, 1.0},
      {"stepper-no-detent", "the same motor without detent torque", false, 1.0},
      {"stepper-geared", "with detent, behind a reduction of 20", true, 0.05}};
  Section section;
  section.title = "Steppers for galvos: S4's ±0.05 mm";
  std::vector<std::vector<std::string>> rows;
  std::vector<Map> maps;
  for (const Variant& variant : variants) {
    maps.push_back(mapOf(as_shipped, variant, subdivisions, speeds_mm_s));
    rows.push_back({variant.says, fmt::format("{:.3f} mm", maps.back().best_mm),
                    fmt::format("{} of {}", maps.back().holds, maps.back().cells), maps.back().where,
                    fmt::format("{}", maps.back().losses)});
    section.figures.push_back({variant.name, maps.back().plot.title, svgOf(maps.back().plot)});
  }
  section.markdown = fmt::format(
      "S4 replaces the galvos by steppers with subdivision drives and reports ±0.05 mm, without speed, motor "
      "or subdivision. Here\nthe head of `two-mirror-stepper.yaml` (throw {:g} mm) draws three lines of 30 "
      "mm "
      "and a circle of {:g} mm radius on a sheet at\nrest, from rest to rest with {:g} mm of run-up; the "
      "deviation is that of the lit spot from the mark, until 20 ms after its end.\nSubdivision (and one "
      "pulse on the "
      "sheet in mm) against mark speed; fast solver.\n\n",
      as_shipped.head.throw_mm, kMirrorRadius_mm, kRunUp_mm);
  section.markdown += markdownTable(
      {"mirror drive", "best", "cells within ±0.05 mm", "holds", "cells with lost steps"}, rows);
  section.markdown += verdict(maps);
  section.figures.push_back(overReduction(as_shipped, quick));
  const double pulse_mm = 2.0 * built(as_shipped, variants[1], subdivisions.back()).galvo_x.step *
                          (as_shipped.head.throw_mm + as_shipped.head.mirror_spacing_mm);
  section.atMost(
      "as built, slow and fine: largest deviation over T_d / (T_h N) of the detent and the rounding",
      maps[0].slow_fine_mm / (detentError_mm(as_shipped) + roundingError_mm(as_shipped, pulse_mm)), 1.0, "");
  section.atLeast("and over the detent's share alone", maps[0].slow_fine_mm / detentError_mm(as_shipped), 0.7,
                  "");
  section.atMost(
      "without detent, slow and fine: largest deviation over rounding and the swing that it may raise",
      maps[1].slow_fine_mm / roundingError_mm(as_shipped, pulse_mm), 1.0, "");
  return section;
}

}  // namespace kerfbench::validation
