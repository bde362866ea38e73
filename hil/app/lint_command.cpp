// SPDX-License-Identifier: Apache-2.0
#include "hil/app/lint_command.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <set>
#include <string>

#include "firmware_under_test/planner/order/hand_order.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/calibration_file.h"
#include "hil/calibrate/files/target_file.h"
#include "hil/dieline/file_format.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/dieline/remarks.h"
#include "hil/fold/fold_machine.h"
#include "hil/fold/fold_scenario.h"
#include "hil/judge/run_options.h"
#include "hil/machine_file/machine_check.h"
#include "hil/run/controller_fit.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/case.h"
#include "hil/witness/witness.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

void say(const std::string& line) { base::toTerminal(stdout, line + "\n"); }

// A scenario names a dieline; a machine does not. What it extends counts as well.
bool isScenario(const fs::path& path) {
  const auto file = base::YamlReader::openFile(path);
  return file.has("dieline") || file.has("firmware");
}

// What a second reader says of a drawing. Returns the exit code.
int lintWitness(const dieline::Dieline& dieline, const dieline::DrawingOptions& rules,
                const judge::RunOptions& options, base::Console& console) {
  const witness::Testimony testimony =
      witness::testimonyOf(dieline, rules, witness::witnessBeside(options.bin_dir));
  const bool agrees = testimony.kind == witness::Testimony::Kind::kAgrees;
  if (agrees && options.quiet) return 0;
  for (const std::string& sentence : testimony.sentences)
    console.result(fmt::format("{}: {}: {}", dieline.path, agrees ? "note" : "error", sentence));
  return witness::exitCodeOf(testimony.kind);
}

// Returns the exit code: a drawing with errors is bad input.
int lintDrawing(const fs::path& path, DrawingRules rules, bool with_witness,
                const judge::RunOptions& options) {
  const bool quiet = options.quiet;
  base::Console console(quiet);
  rules.options.progress = base::progressOn(console);
  const dieline::Dieline dieline = dieline::readDieline(path, rules.options);
  constexpr std::size_t kMost = 20;  // The worst of each kind.
  const dieline::LintReport report = dieline::lintDieline(dieline, kMost, rules.options.progress);
  const auto warn = [&](const std::string& text) {
    console.say(fmt::format("{}: warning: {}", path.string(), text));
  };
  std::size_t errors = 0;
  for (const dieline::LintFinding& finding : report.findings) {
    const bool is_error = finding.is_error && !dieline::isAccepted(finding, rules.accepted);
    errors += is_error ? 1 : 0;
    if (quiet && !is_error) continue;
    console.result(fmt::format("{}: {} at ({:.3f}, {:.3f}) mm, layer {}: {}", path.string(),
                               is_error ? "error" : "warning", finding.p_mm.x(), finding.p_mm.y(),
                               finding.layer.empty() ? "-" : finding.layer, finding.message));
  }
  for (const std::string& sentence : dieline::uncounted(report)) warn(sentence);
  if (const auto advice = dieline::adviceOnRepeats(report)) warn(*advice);
  for (const std::string& sentence : dieline::acceptedSentences(report, rules.accepted)) warn(sentence);
  if (!quiet) {
    for (const dieline::Remark& remark : dieline::remarksOf(dieline)) {
      console.say(fmt::format("{}{}: {}: {}", path.string(),
                              remark.line > 0 ? fmt::format(":{}", remark.line) : "",
                              remark.is_warning ? "warning" : "note", remark.message));
    }
    const auto box = dieline.bounds();
    if (!box.isEmpty()) {
      console.say(fmt::format("{}: {} entities, {:.2f} x {:.2f} mm", path.string(), dieline.entities.size(),
                              box.sizes().x(), box.sizes().y()));
    }
  }
  const int code = with_witness ? lintWitness(dieline, rules.options, options, console) : 0;
  return base::worstExitCode(code, errors == 0 ? 0 : base::kExitInput);
}

// A machine can be described before its cameras are calibrated; a run of it would be INVALID.
void warnOfCameras(const fs::path& path, scenario::Case& test_case, const machine_file::MachineFile& file,
                   bool quiet) {
  test_case.machine = file.machine;
  test_case.spot_camera = file.spot_camera;
  test_case.kerf_camera = file.kerf_camera;
  if (quiet) return;
  for (const std::string& problem : scenario::readCalibrations(test_case).problems)
    say(fmt::format("{}: warning: {}", path.string(), problem));
}

// An order by hand that is none of this drawing is refused; one that is doubtful is told.
void lintOrder(const fs::path& path, const scenario::Scenario& of, bool quiet) {
  if (of.job.order != planner::JobParameters::Order::kGiven || !of.job_gcode.empty()) return;
  const scenario::Case whole = scenario::caseOf(of);
  for (const std::string& doubt : planner::orderDoubts(*whole.dieline, of.job.given_order))
    if (!quiet) say(fmt::format("{}: warning: planner.order: {}", path.string(), doubt));
}

// Returns the exit code.
int lintFile(const fs::path& path, const fs::path& image, const DrawingChoice& drawings,
             const judge::RunOptions& options) {
  const scenario::ImagePath images{options.bin_dir.parent_path() / "firmware", image};
  if (dieline::fileFormatOf(path)) {
    const DrawingRules rules = drawingRules(drawings, images);
    return lintDrawing(path, rules, drawings.witness || rules.witness_required, options);
  }
  if (!drawings.empty())
    throw dieline::DielineError(path.string() +
                                ": options of a drawing are for drawings (.dxf, .svg, .cf2, .pdf)");
  const auto file_keys = base::YamlReader::openFile(path);
  if (drawings.witness && !isScenario(path))
    throw dieline::DielineError(path.string() +
                                ": --witness is for drawings, and for scenarios that name one");
  if (file_keys.has("camera_id")) {
    (void)calibrate::readCalibrationFile(path);
    return 0;
  }
  if (file_keys.has("square_mm")) {
    (void)calibrate::readTarget(path);
    return 0;
  }
  if (file_keys.has("faces")) {
    (void)fold::readFoldScenario(path);
    return 0;
  }
  if (file_keys.has("survey")) {
    (void)fold::readFoldMachine(path);
    return 0;
  }
  scenario::Case test_case;
  if (isScenario(path)) {
    test_case.scenario = scenario::readScenario(path, images);
    const machine_file::MachineFile file = machine_file::readMachineFile(test_case.scenario.machine);
    warnOfCameras(path, test_case, file, options.quiet);
    scenario::refuseUnwired(test_case);
    run::refuseUnfitController(test_case, options.bin_dir);
    machine_file::refuseUnfit(file, scenario::webOf(test_case));
    const scenario::Scenario& of = test_case.scenario;
    const int code = lintDrawing(of.dieline, {of.drawing, of.accepted, of.witness_required},
                                 drawings.witness || of.witness_required, options);
    if (code == 0) lintOrder(path, of, options.quiet);
    return code;
  }
  const machine_file::MachineFile file = machine_file::readMachineFile(path);
  test_case.scenario.machine = path;
  warnOfCameras(path, test_case, file, options.quiet);
  machine_file::refuseUnfit(file);
  return 0;
}

}  // namespace

int lintCommand(const std::vector<fs::path>& files, const fs::path& image, const DrawingChoice& drawings,
                const judge::RunOptions& options) {
  int code = 0;
  const auto count = [&code](int one) { code = base::worstExitCode(code, one); };
  for (const fs::path& path : files) {
    try {
      const int found = lintFile(path, image, drawings, options);
      if (found == 0 && !options.quiet) say(fmt::format("{}: good", path.string()));
      count(found);
    } catch (const base::ConfigError& e) {
      base::toTerminal(stderr, fmt::format("{}\n", e.what()));
      count(base::kExitInput);
    } catch (const dieline::DielineError& e) {
      base::toTerminal(stderr, fmt::format("{}\n", e.what()));
      count(base::kExitInput);
    } catch (const base::InputError& e) {
      base::toTerminal(stderr, fmt::format("{}\n", e.what()));
      count(base::kExitInput);
    }
  }
  return code;
}

}  // namespace kerfbench::app
