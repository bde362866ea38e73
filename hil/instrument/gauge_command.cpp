// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/gauge_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/terminal.h"
#include "hil/base/version.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/png.h"
#include "hil/cli/run_guarded.h"
#include "hil/gauge/gauge.h"
#include "hil/gauge/gauge_report.h"
#include "hil/judge/results_folder.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/case.h"

namespace kerfbench::instrument {
namespace {

namespace fs = std::filesystem;

gauge::GaugeSetup readSetup(const fs::path& machine, gauge::GaugeFacts& facts) {
  const machine_file::MachineFile file = machine_file::readMachineFile(machine);
  scenario::Case test_case;
  test_case.scenario.machine = machine;
  test_case.machine = file.machine;
  test_case.spot_camera = file.spot_camera;
  test_case.kerf_camera = file.kerf_camera;
  const scenario::BenchCameras cameras = scenario::readCalibrations(test_case);
  std::string problems;
  for (const std::string& problem : cameras.problems) problems += (problems.empty() ? "" : "\n") + problem;
  if (!problems.empty()) throw base::ConfigError(problems);
  facts.machine = file.machine.name;
  for (const auto& [which, fact] : cameras.facts)
    (which == "kerf camera" ? facts.kerf_camera : facts.spot_camera) = fact;
  facts.version = base::version();
  gauge::GaugeSetup setup;
  setup.machine = file.machine;
  setup.spread = file.spread;
  setup.kerf_calibration = cameras.kerf.value();
  setup.spot_calibration = cameras.spot.value();
  setup.radius_sigma = file.beam_radius_sigma;
  setup.scale_sigma = std::hypot(file.kerf_camera.target_scale_sigma, 1e-6 * scenario::kUsualSwelling_ppm);
  setup.open_gray_sigma = file.kerf_camera.open_gray_sigma;
  return setup;
}

/// Done, of how many, and for how long still; told at most ten times a second.
class Eta {
 public:
  explicit Eta(base::Console& console) : console_(console), start_(Clock::now()), last_(start_) {}
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
  base::Console& console_;
  Clock::time_point start_, last_;
};

/// Leaves out what nobody asked for.
gauge::GaugeOptions chosen(const GaugeCommandOptions& options) {
  gauge::GaugeOptions gauge = options.gauge;
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

const char* stateName(gauge::Claim::State state) {
  return state == gauge::Claim::State::kHolds   ? "holds"
         : state == gauge::Claim::State::kFails ? "FAILS"
                                                : "open";
}

void tellReadings(const std::vector<gauge::Reading>& readings, base::Console& console) {
  console.result(fmt::format("  {:<38} {:>10} {:>9} {:>10} {:>9} {:>8}", "quantity, µm", "measured", "U",
                             "true", "error", "error/U"));
  for (const gauge::Reading& r : readings) {
    console.result(fmt::format("  {:<38} {:>10.3f} {:>8.3f} {:>10.3f} {:>+9.3f} {:>8.2f}{}", r.quantity,
                               1e3 * r.value, 1e3 * r.U, 1e3 * r.truth, 1e3 * (r.value - r.truth),
                               (r.value - r.truth) / r.U,
                               std::abs(r.value - r.truth) > r.U ? "  missed" : ""));
  }
}

void tellQuantities(const gauge::GaugeSection& section, base::Console& console) {
  console.say(fmt::format("  {:<8} {:<36} {:>6} {:>7} {:>9} {:>8} {:>8} {:>8} {:>8}", section.preset,
                          "quantity, µm", "cases", "within", "mean err", "σ err", "U median", "mean z",
                          "RMS z"));
  for (const gauge::Coverage& c : section.coverage) {
    console.say(
        fmt::format("           {:<36} {:>6} {:>6.1f}% {:>+9.3f} {:>7.3f} {:>8.3f} {:>+8.2f} {:>8.2f}{}",
                    c.quantity, c.cases, 100.0 * static_cast<double>(c.hits) / static_cast<double>(c.cases),
                    1e3 * c.error_mm.mean, 1e3 * c.error_mm.sigma, 1e3 * c.U_median_mm, c.z_mean, c.z_sigma,
                    c.worst.empty() ? "" : "  e.g. " + c.worst.front()));
  }
}

int repeatCase(const gauge::GaugeSetup& setup, const GaugeCommandOptions& options, base::Console& console) {
  const auto id = gauge::caseFromName(options.test_case);
  if (!id) {
    base::toTerminal(
        stderr,
        fmt::format("--case: '{}' is no case; like static-bad-17, presets static, dynamic, ideal, studies "
                    "bad, good, coverage, repeat, relay, grr, still, stillrepeat\n",
                    options.test_case));
    return base::kExitUsage;
  }
  if (gauge::watchesSpot(id->study)) {
    const gauge::StillOutcome o = gauge::StillStudy(setup).run(gauge::stillCase(*id, options.gauge.seed));
    console.result(fmt::format("{}: stillness {}", o.name, inspect::verdictName(o.verdict)));
    for (const std::string& problem : o.problems) console.result("  " + problem);
    tellReadings(o.readings, console);
    return 0;
  }
  const gauge::KerfStudy study(setup);
  const gauge::KerfCase c = gauge::kerfCase(*id, options.gauge.seed, study);
  const gauge::KerfStudy::Whole whole = study.runWhole(c);
  console.result(fmt::format("{}: {}, true deviation {:.2f} µm", c.name,
                             inspect::verdictName(whole.outcome.verdict), 1e3 * whole.outcome.truth_mm));
  if (setup.mismatch) console.result("  world " + gauge::textOf(whole.world));
  for (const gauge::Fault& f : c.faults) {
    console.result(
        fmt::format("  fault {:<9} {:+.2f} µm, E{}, place {:.2f}, length {:.2f} mm, direction {:.0f}°, {}",
                    gauge::faultName(f.kind), 1e3 * f.size_mm, f.entity, f.place, f.length_mm,
                    57.29578 * f.direction_rad, f.at_start ? "at start" : "at end"));
  }
  for (const std::string& problem : whole.outcome.problems) console.result("  " + problem);
  for (const inspect::Check& check : whole.measurement.result.checks) {
    console.result(fmt::format("  {:<10} {:<14} {:.5g} ± {:.3g} {}, limit {:g}, {}",
                               inspect::verdictName(check.verdict), check.name, check.value, check.u,
                               check.unit, check.limit, check.subject));
  }
  tellReadings(whole.outcome.readings, console);
  console.result("  lines: worst measured, U, true; width measured, U, true; µm");
  for (std::size_t k = 0; k < whole.truth.entities.size(); ++k) {
    const inspect::EntityResult& e = whole.measurement.result.entities[k];
    const gauge::EntityTruth& t = whole.truth.entities[k];
    console.result(fmt::format("    E{} {:8.3f} {:6.3f} {:8.3f}   {:8.3f} {:6.3f} {:8.3f}", t.entity,
                               1e3 * std::abs(e.worst_mm), 1e3 * e.worst_U_mm, 1e3 * t.worst_mm,
                               1e3 * e.width_mm, 1e3 * e.width_U_mm, 1e3 * t.width_mm));
  }
  const fs::path picture = options.results_dir / (c.name + ".png");
  fs::create_directories(options.results_dir);
  const auto png = camera::encodePng(whole.picture);
  base::writeFileAtomically(picture, std::string(png.begin(), png.end()));
  console.say("picture: " + picture.string());
  return 0;
}

int gauge(const GaugeCommandOptions& options) {
  base::Console console(options.quiet);
  gauge::GaugeFacts facts;
  gauge::GaugeSetup setup = readSetup(options.machine, facts);
  setup.mismatch = options.mismatch;
  if (setup.mismatch) {
    setup.radius_sigma = gauge::kToldRadius;
    setup.print_sigma_mm = gauge::kToldPrint_mm;
  }
  facts.command = options.command_line;
  if (!options.test_case.empty()) return repeatCase(setup, options, console);
  judge::refuseForeignResults(options.results_dir, "gauge");
  console.say(fmt::format("gauge: {}, cameras {} and {}", setup.machine.name,
                          setup.kerf_calibration.camera_id, setup.spot_calibration.camera_id));
  const gauge::GaugeOptions asked = chosen(options);
  Eta eta(console);
  const gauge::GaugeResult result =
      gauge::runGauge(setup, asked, [&](std::size_t done, std::size_t all) { eta(done, all); });
  for (const gauge::GaugeSection& s : result.sections) {
    for (const std::string& wrong : s.wrong) console.say("  " + wrong);
  }
  for (const gauge::GaugeSection& s : result.sections) tellQuantities(s, console);
  for (const gauge::Claim& claim : result.claims) {
    const std::string line = fmt::format("  {:<6} {:<8} {:<60} {} (limit {})", stateName(claim.state),
                                         claim.preset, claim.what, claim.measured, claim.limit);
    if (claim.state == gauge::Claim::State::kFails) {
      console.result(line);
    } else {
      console.say(line);
    }
  }
  const auto failed = std::ranges::count_if(
      result.claims, [](const gauge::Claim& c) { return c.state == gauge::Claim::State::kFails; });
  console.result(fmt::format("gauge: {} claims, {} do not hold", result.claims.size(), failed));
  judge::ResultsFolder folder(options.results_dir, "gauge");
  base::writeFileAtomically(folder.staging() / "gauge.json", gauge::gaugeJson(result, asked, facts));
  base::writeFileAtomically(folder.staging() / "gauge.html", gauge::gaugeHtml(result, asked, facts));
  folder.commit();
  console.say(fmt::format("report: {}", (folder.place() / "gauge.html").string()));
  return result.holds() ? 0 : 1;
}

}  // namespace

int gaugeCommand(const GaugeCommandOptions& options) {
  return cli::runGuarded(options.machine, [&] { return gauge(options); });
}

}  // namespace kerfbench::instrument
