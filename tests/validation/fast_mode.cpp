// SPDX-License-Identifier: Apache-2.0
// The fast solver compared with the reference: machines x motions x presets.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "hil/machine_file/machine_file.h"
#include "tests/validation/studies.h"
#include "tests/validation/support/machine_run.h"
#include "tests/validation/support/svg.h"
#include "twin/description/imperfections.h"

namespace kerfbench::validation {
namespace {

using Eigen::Vector2d;

struct Job {
  std::string name;
  Motion motion;
};

// Sharp corners at speed, a circle, and small steps; `size_mm` fits the field.
std::vector<Job> jobs(double size_mm, double speed_mm_s) {
  const Speeds constant{speed_mm_s, speed_mm_s, speed_mm_s};
  const Speeds ramps{0.0, speed_mm_s, 0.0, 10.0 * speed_mm_s};
  Motion zigzag(Vector2d(-0.5 * size_mm, -0.5 * size_mm));
  for (int i = 0; i < 6; ++i) {
    const double side = i % 2 == 0 ? 0.5 : -0.5;
    zigzag.line({-0.5 * size_mm + (i + 1) * size_mm / 6.0, side * size_mm}, constant, true);
  }
  Motion circle({0.5 * size_mm, 0.0});
  circle.arc(Vector2d::Zero(), 2.0 * std::numbers::pi, ramps, true);
  Motion comb(Vector2d::Zero());
  for (int i = 1; i <= 10; ++i) {
    comb.line({0.2 * i, i % 2 == 0 ? 0.0 : 1.0}, constant, true);
    comb.rest(5e-3);
  }
  return {{"zigzag", zigzag}, {"circle", circle}, {"comb", comb}};
}

struct Comparison {
  double worst_um{};
  long long lost_reference{}, lost_fast{};
  bool same_lost{true};
};

Comparison compare(const twin::MachineDescription& machine, const twin::WebDescription& web,
                   const Motion& motion) {
  constexpr double kTail_s = 20e-3;
  const auto reference = runMachine(machine, web, motion, kTail_s, twin::Fidelity::kReference);
  const auto fast = runMachine(machine, web, motion, kTail_s, twin::Fidelity::kFast);
  Comparison result;
  double first_loss_s = INFINITY;
  for (const auto* run : {&reference, &fast}) {
    if (!run->lost.empty()) first_loss_s = std::min(first_loss_s, run->lost.front().time_s);
  }
  for (std::size_t i = 0; i < reference.spot_mm.size(); ++i) {
    if (reference.time_s[i] > first_loss_s) break;
    raiseTo(result.worst_um, 1e3 * (reference.spot_mm[i] - fast.spot_mm[i]).norm());
  }
  for (const auto& lost : reference.lost) result.lost_reference += lost.full_steps;
  for (const auto& lost : fast.lost) result.lost_fast += lost.full_steps;
  result.same_lost = reference.lost.size() == fast.lost.size();
  for (std::size_t i = 0; result.same_lost && i < reference.lost.size(); ++i) {
    result.same_lost = reference.lost[i].axis == fast.lost[i].axis &&
                       reference.lost[i].full_steps == fast.lost[i].full_steps;
  }
  return result;
}

// A line that changes its speed while the beam works.
twin::WebDescription movingWeb() {
  twin::WebDescription web = restingWeb();
  web.belt_speed_mm_s = 60.0;
  web.belt_speed_changes = {{0.1, 60.0}, {0.2, 200.0}, {0.4, 30.0}};
  return web;
}

struct Tried {
  const char* file;
  double size_mm;
  double speed_mm_s;
};

}  // namespace

Section fastMode(const Context& context) {
  const bool quick = context.effort == Effort::kQuick;
  std::vector<Tried> machines{{"two-mirror", 40.0, 1000.0},
                              {"two-mirror-stepper", 20.0, 100.0},
                              {"two-mirror-stepper", 60.0, 20'000.0},
                              {"f-theta-300", 60.0, 1500.0},
                              {"strip-gantry", 30.0, 200.0}};
  if (quick) machines = {{"two-mirror", 10.0, 1000.0}, {"two-mirror-stepper", 60.0, 20'000.0}};
  Section section;
  section.title = "Fast mode against reference mode";
  std::vector<std::vector<std::string>> rows;
  double worst_um = 0.0;
  int runs = 0, same_lost = 0, with_loss = 0;
  for (const Tried& tried : machines) {
    const auto file = context.source_dir / "fixtures/machines" / (std::string(tried.file) + ".yaml");
    const auto drawing = machine_file::readMachine(file);
    for (const auto& [preset, preset_name] :
         {std::pair(twin::Preset::kIdeal, "ideal"), std::pair(twin::Preset::kStatic, "static"),
          std::pair(twin::Preset::kDynamic, "dynamic")}) {
      if (quick && preset != twin::Preset::kDynamic) continue;
      const auto machine = twin::drawImperfections(drawing, {}, preset, 7).machine;
      for (const Job& job : jobs(tried.size_mm, tried.speed_mm_s)) {
        if (quick && job.name == "circle") continue;
        const Comparison found = compare(machine, movingWeb(), job.motion);
        ++runs;
        same_lost += found.same_lost ? 1 : 0;
        with_loss += found.lost_reference != 0 || found.lost_fast != 0 ? 1 : 0;
        raiseTo(worst_um, found.worst_um);
        rows.push_back({fmt::format("{}, {:g} mm/s", tried.file, tried.speed_mm_s), preset_name, job.name,
                        figureText(found.worst_um, 1e-6), std::to_string(found.lost_reference),
                        std::to_string(found.lost_fast)});
      }
    }
  }
  section.markdown = fmt::format(
      "The same pulses through both solvers, {} runs: every machine file, the three presets of imperfections "
      "(seed 7), corners taken\nat full speed, a circle, short steps with rests; the belt changes its speed "
      "meanwhile. Largest distance of the two\nspots at any of the steps of 10 µs, up to the first lost "
      "step: a rotor that slips is thrown about.\n\n",
      runs);
  section.markdown +=
      markdownTable({"machine", "preset", "motion", "spot, µm", "full steps lost: reference", "fast"}, rows);
  section.atMost("largest distance of the spots in any run", worst_um, 1.0, "µm", 1e-6);
  section.atLeast("runs in which both lose the same steps", same_lost, runs, "");
  section.atLeast("runs that lose steps at all, so that there is something to compare", with_loss, 1, "");
  return section;
}

}  // namespace kerfbench::validation
