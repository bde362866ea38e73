// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "hil/app/camera_files.h"
#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/console.h"
#include "hil/app/exit_codes.h"
#include "hil/app/results_folder.h"
#include "hil/base/atomic_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/png.h"
#include "hil/gauge/gauge.h"
#include "hil/gauge/gauge_report.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

GaugeSetup readSetup(const fs::path& machine, GaugeFacts& facts) {
  const MachineFile file = readMachineFile(machine);
  Case the_case;
  the_case.scenario.machine = machine;
  the_case.machine = file.machine;
  the_case.spot_camera = file.spot_camera;
  the_case.kerf_camera = file.kerf_camera;
  const BenchCameras cameras = readCalibrations(the_case);
  std::string problems;
  for (const std::string& problem : cameras.problems) problems += (problems.empty() ? "" : "\n") + problem;
  if (!problems.empty()) throw ConfigError(problems);
  facts.machine = file.machine.name;
  for (const auto& [which, fact] : cameras.facts)
    (which == "kerf camera" ? facts.kerf_camera : facts.spot_camera) = fact;
  facts.version = KERFBENCH_VERSION;
  GaugeSetup setup;
  setup.machine = file.machine;
  setup.spread = file.spread;
  setup.kerf_calibration = cameras.kerf.value();
  setup.spot_calibration = cameras.spot.value();
  return setup;
}

/// Done, of how many, and for how long still; told at most ten times a second.
class Eta {
 public:
  explicit Eta(Console& console) : console_(console), start_(Clock::now()), last_(start_) {}
  void operator()(std::size_t done, std::size_t all) {
    const auto now = Clock::now();
    if (done < all && now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    const double rest_s = std::chrono::duration<double>(now - start_).count() / static_cast<double>(done) *
                          static_cast<double>(all - done);
    console_.progress(-1, fmt::format("{} of {} cases, about {:.0f} s to go", done, all, rest_s));
  }

 private:
  using Clock = std::chrono::steady_clock;
  Console& console_;
  Clock::time_point start_, last_;
};

/// Leaves out what nobody asked for.
GaugeOptions chosen(const GaugeCommandOptions& options) {
  GaugeOptions gauge = options.gauge;
  const auto asked = [&](std::string_view study) {
    return options.studies.empty() || std::ranges::find(options.studies, study) != options.studies.end();
  };
  if (!asked("verdicts")) gauge.bad = gauge.good = 0;
  if (!asked("coverage")) gauge.coverage = 0;
  if (!asked("type1")) gauge.repeats = 0;
  if (!asked("grr")) gauge.grr = false;
  if (!asked("stillness")) gauge.still = gauge.still_repeats = 0;
  return gauge;
}

const char* stateName(Claim::State state) {
  return state == Claim::State::kHolds ? "holds" : state == Claim::State::kFails ? "FAILS" : "open";
}

void tellReadings(const std::vector<Reading>& readings, Console& console) {
  console.result(fmt::format("  {:<38} {:>10} {:>9} {:>10} {:>9} {:>8}", "quantity, µm", "measured", "U",
                             "true", "error", "error/U"));
  for (const Reading& r : readings) {
    console.result(fmt::format("  {:<38} {:>10.3f} {:>8.3f} {:>10.3f} {:>+9.3f} {:>8.2f}{}", r.quantity,
                               1e3 * r.value, 1e3 * r.U, 1e3 * r.truth, 1e3 * (r.value - r.truth),
                               (r.value - r.truth) / r.U,
                               std::abs(r.value - r.truth) > r.U ? "  missed" : ""));
  }
}

void tellQuantities(const GaugeSection& section, Console& console) {
  console.say(fmt::format("  {:<8} {:<36} {:>6} {:>7} {:>9} {:>8} {:>8} {:>8} {:>8}", section.preset,
                          "quantity, µm", "cases", "within", "mean err", "σ err", "U median", "mean z",
                          "RMS z"));
  for (const Coverage& c : section.coverage) {
    console.say(
        fmt::format("           {:<36} {:>6} {:>6.1f}% {:>+9.3f} {:>7.3f} {:>8.3f} {:>+8.2f} {:>8.2f}{}",
                    c.quantity, c.cases, 100.0 * static_cast<double>(c.hits) / static_cast<double>(c.cases),
                    1e3 * c.error_mm.mean, 1e3 * c.error_mm.sigma, 1e3 * c.U_median_mm, c.z_mean, c.z_sigma,
                    c.worst.empty() ? "" : "  e.g. " + c.worst.front()));
  }
}

int repeatCase(const GaugeSetup& setup, const GaugeCommandOptions& options, Console& console) {
  const auto id = caseFromName(options.the_case);
  if (!id) {
    std::fputs(
        fmt::format("--case: '{}' is no case; like static-bad-17, presets static, dynamic, ideal, studies "
                    "bad, good, coverage, repeat, relay, grr, still, stillrepeat\n",
                    options.the_case)
            .c_str(),
        stderr);
    return kExitUsage;
  }
  if (watchesSpot(id->study)) {
    const StillOutcome o = StillStudy(setup).run(stillCase(*id, options.gauge.seed));
    console.result(fmt::format("{}: stillness {}", o.name, verdictName(o.verdict)));
    for (const std::string& problem : o.problems) console.result("  " + problem);
    tellReadings(o.readings, console);
    return 0;
  }
  const KerfStudy study(setup);
  const KerfCase c = kerfCase(*id, options.gauge.seed, study);
  const KerfStudy::Whole whole = study.runWhole(c);
  console.result(fmt::format("{}: {}, true deviation {:.2f} µm", c.name, verdictName(whole.outcome.verdict),
                             1e3 * whole.outcome.truth_mm));
  for (const Fault& f : c.faults) {
    console.result(
        fmt::format("  fault {:<9} {:+.2f} µm, E{}, place {:.2f}, length {:.2f} mm, direction {:.0f}°, {}",
                    faultName(f.kind), 1e3 * f.size_mm, f.entity, f.place, f.length_mm,
                    57.29578 * f.direction_rad, f.at_start ? "at start" : "at end"));
  }
  for (const std::string& problem : whole.outcome.problems) console.result("  " + problem);
  for (const Check& check : whole.measurement.result.checks) {
    console.result(fmt::format("  {:<10} {:<14} {:.5g} ± {:.3g} {}, limit {:g}, {}",
                               verdictName(check.verdict), check.name, check.value, check.u, check.unit,
                               check.limit, check.subject));
  }
  tellReadings(whole.outcome.readings, console);
  console.result("  lines: worst measured, U, true; width measured, U, true; µm");
  for (std::size_t k = 0; k < whole.truth.entities.size(); ++k) {
    const EntityResult& e = whole.measurement.result.entities[k];
    const EntityTruth& t = whole.truth.entities[k];
    console.result(fmt::format("    E{} {:8.3f} {:6.3f} {:8.3f}   {:8.3f} {:6.3f} {:8.3f}", t.entity,
                               1e3 * std::abs(e.worst_mm), 1e3 * e.worst_U_mm, 1e3 * t.worst_mm,
                               1e3 * e.width_mm, 1e3 * e.width_U_mm, 1e3 * t.width_mm));
  }
  const fs::path picture = options.results_dir / (c.name + ".png");
  fs::create_directories(options.results_dir);
  const auto png = encodePng(whole.picture);
  writeFileAtomically(picture, std::string(png.begin(), png.end()));
  console.say("picture: " + picture.string());
  return 0;
}

int gauge(const GaugeCommandOptions& options) {
  Console console(options.quiet);
  GaugeFacts facts;
  const GaugeSetup setup = readSetup(options.machine, facts);
  facts.command = options.command_line;
  if (!options.the_case.empty()) return repeatCase(setup, options, console);
  console.say(fmt::format("gauge: {}, cameras {} and {}", setup.machine.name,
                          setup.kerf_calibration.camera_id, setup.spot_calibration.camera_id));
  const GaugeOptions asked = chosen(options);
  Eta eta(console);
  const GaugeResult result =
      runGauge(setup, asked, [&](std::size_t done, std::size_t all) { eta(done, all); });
  for (const GaugeSection& s : result.sections) {
    for (const std::string& wrong : s.wrong) console.say("  " + wrong);
  }
  for (const GaugeSection& s : result.sections) tellQuantities(s, console);
  for (const Claim& claim : result.claims) {
    const std::string line = fmt::format("  {:<6} {:<8} {:<60} {} (limit {})", stateName(claim.state),
                                         claim.preset, claim.what, claim.measured, claim.limit);
    if (claim.state == Claim::State::kFails) {
      console.result(line);
    } else {
      console.say(line);
    }
  }
  const auto failed =
      std::ranges::count_if(result.claims, [](const Claim& c) { return c.state == Claim::State::kFails; });
  console.result(fmt::format("gauge: {} claims, {} do not hold", result.claims.size(), failed));
  ResultsFolder folder(options.results_dir, "gauge");
  writeFileAtomically(folder.staging() / "gauge.json", gaugeJson(result, asked, facts));
  writeFileAtomically(folder.staging() / "gauge.html", gaugeHtml(result, asked, facts));
  folder.commit();
  console.say(fmt::format("report: {}", (folder.place() / "gauge.html").string()));
  return result.holds() ? 0 : 1;
}

}  // namespace

int gaugeCommand(const GaugeCommandOptions& options) {
  return guarded(options.machine, [&] { return gauge(options); });
}

}  // namespace kerfbench::hil
