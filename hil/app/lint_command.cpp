// SPDX-License-Identifier: Apache-2.0
#include "hil/app/lint_command.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "firmware_under_test/planner/order/hand_order.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_faults.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/calibration_file.h"
#include "hil/calibrate/files/target_file.h"
#include "hil/cli/standard_input.h"
#include "hil/dieline/file_format.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/dieline/remarks.h"
#include "hil/fold/fold_machine.h"
#include "hil/fold/fold_scenario.h"
#include "hil/judge/run_options.h"
#include "hil/machine_file/machine_check.h"
#include "hil/machine_file/machine_text.h"
#include "hil/run/controller_fit.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/case.h"
#include "hil/witness/witness.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

void say(const std::string& line) { base::toTerminal(stdout, line + "\n"); }

/// A file of settings that is checked, or a text that came on standard input.
struct LintedText {
  fs::path path;
  std::optional<std::string> text;  ///< Nothing: that of the file.

  [[nodiscard]] base::YamlReader opened() const {
    return text ? base::YamlReader::openText(path, *text) : base::YamlReader::openFile(path);
  }
  [[nodiscard]] scenario::Scenario scenario(const scenario::ImagePath& images) const {
    if (!text) return scenario::readScenario(path, images);
    scenario::ScenarioDraft draft = scenario::draftScenario(path, *text, images);
    if (!draft.faults.empty()) throw base::ConfigError(base::faultsText(draft.faults));
    return std::move(draft.scenario);
  }
  [[nodiscard]] machine_file::MachineFile machine() const {
    return text ? machine_file::readMachineText(path, *text) : machine_file::readMachineFile(path);
  }
};

// A scenario names a dieline; a machine does not. What it extends counts as well.
bool isScenario(const base::YamlReader& file) { return file.has("dieline") || file.has("firmware"); }

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
int lintDrawing(const fs::path& path, const std::string& name, DrawingRules rules, bool with_witness,
                const judge::RunOptions& options) {
  const bool quiet = options.quiet;
  base::Console console(quiet);
  rules.options.progress = base::progressOn(console);
  dieline::Dieline dieline = dieline::readDieline(path, rules.options);
  constexpr std::size_t kMost = 20;  // The worst of each kind.
  const dieline::LintReport report = dieline::lintDieline(dieline, kMost, rules.options.progress);
  const auto warn = [&](const std::string& text) { console.say(fmt::format("{}: warning: {}", name, text)); };
  std::size_t errors = 0;
  for (const dieline::LintFinding& finding : report.findings) {
    const bool is_error = finding.is_error && !dieline::isAccepted(finding, rules.accepted);
    errors += is_error ? 1 : 0;
    if (quiet && !is_error) continue;
    console.result(fmt::format("{}: {} at ({:.3f}, {:.3f}) mm, layer {}: {}", name,
                               is_error ? "error" : "warning", finding.p_mm.x(), finding.p_mm.y(),
                               finding.layer.empty() ? "-" : finding.layer, finding.message));
  }
  for (const std::string& sentence : dieline::uncounted(report)) warn(sentence);
  if (const auto advice = dieline::adviceOnRepeats(report)) warn(*advice);
  for (const std::string& sentence : dieline::acceptedSentences(report, rules.accepted)) warn(sentence);
  if (!quiet) {
    for (const dieline::Remark& remark : dieline::remarksOf(dieline)) {
      console.say(fmt::format("{}{}: {}: {}", name, remark.line > 0 ? fmt::format(":{}", remark.line) : "",
                              remark.is_warning ? "warning" : "note", remark.message));
    }
    const auto box = dieline.bounds();
    if (!box.isEmpty()) {
      console.say(fmt::format("{}: {} entities, {:.2f} x {:.2f} mm", name, dieline.entities.size(),
                              box.sizes().x(), box.sizes().y()));
    }
  }
  dieline.path = name;  // For the witness's words.
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

/// True for a file of another kind than scenario and machine, and then good.
bool lintOtherSettings(const base::YamlReader& keys, const LintedText& of) {
  using Read = void (*)(const fs::path&);
  const std::pair<const char*, Read> kinds[] = {
      {"camera_id", [](const fs::path& path) { (void)calibrate::readCalibrationFile(path); }},
      {"square_mm", [](const fs::path& path) { (void)calibrate::readTarget(path); }},
      {"faces", [](const fs::path& path) { (void)fold::readFoldScenario(path); }},
      {"survey", [](const fs::path& path) { (void)fold::readFoldMachine(path); }}};
  for (const auto& [key, read] : kinds) {
    if (!keys.has(key)) continue;
    if (of.text)
      throw base::InputError(of.path.string() +
                             ": scenarios, machines and drawings alone are read from standard input");
    read(of.path);
    return true;
  }
  return false;
}

// Returns the exit code.
int lintScenario(const LintedText& linted, const DrawingChoice& drawings, const scenario::ImagePath& images,
                 const judge::RunOptions& options) {
  scenario::Case test_case;
  test_case.scenario = linted.scenario(images);
  const machine_file::MachineFile file = machine_file::readMachineFile(test_case.scenario.machine);
  warnOfCameras(linted.path, test_case, file, options.quiet);
  scenario::refuseUnwired(test_case);
  run::refuseUnfitController(test_case, options.bin_dir);
  machine_file::refuseUnfit(file, scenario::webOf(test_case));
  const scenario::Scenario& of = test_case.scenario;
  const int code =
      lintDrawing(of.dieline, of.dieline.string(), {of.drawing, of.accepted, of.witness_required},
                  drawings.witness || of.witness_required, options);
  if (code == 0) lintOrder(linted.path, of, options.quiet);
  return code;
}

// Returns the exit code.
int lintSettings(const LintedText& linted, const DrawingChoice& drawings, const scenario::ImagePath& images,
                 const judge::RunOptions& options) {
  if (!drawings.empty())
    throw dieline::DielineError(
        linted.path.string() +
        ": --scenario, --unit, --page, --scale, --turn, --shift, --once, --layer and --accept "
        "are for drawings (.dxf, .svg, .cf2, .pdf)");
  const base::YamlReader keys = linted.opened();
  if (drawings.witness && !isScenario(keys))
    throw dieline::DielineError(linted.path.string() +
                                ": --witness is for drawings, and for scenarios that name one");
  if (lintOtherSettings(keys, linted)) return 0;
  if (isScenario(keys)) return lintScenario(linted, drawings, images, options);
  scenario::Case test_case;
  const machine_file::MachineFile file = linted.machine();
  test_case.scenario.machine = linted.path;
  warnOfCameras(linted.path, test_case, file, options.quiet);
  machine_file::refuseUnfit(file);
  return 0;
}

// Returns the exit code. `name`: of the drawing, for people.
int lintNamed(const fs::path& path, const std::string& name, const DrawingChoice& drawings,
              const scenario::ImagePath& images, const judge::RunOptions& options) {
  const DrawingRules rules = drawingRules(drawings, images);
  return lintDrawing(path, name, rules, drawings.witness || rules.witness_required, options);
}

// Returns the exit code.
int lintFile(const fs::path& path, const DrawingChoice& drawings, const scenario::ImagePath& images,
             const judge::RunOptions& options) {
  if (!dieline::fileFormatOf(path)) return lintSettings({path, std::nullopt}, drawings, images, options);
  return lintNamed(path, path.string(), drawings, images, options);
}

// Returns the exit code.
int lintPiped(const std::string& piped, const DrawingChoice& drawings, const scenario::ImagePath& images,
              const judge::RunOptions& options) {
  const std::string text = cli::standardInputText();
  const std::string format = piped.empty() ? cli::extensionByContent(text) : piped;
  if (format == ".yaml") return lintSettings({cli::kStandardInputName, text}, drawings, images, options);
  const cli::InputAsFile file(text, format);
  try {
    return lintNamed(file.path(), cli::kStandardInputName, drawings, images, options);
  } catch (const dieline::DielineError& error) {
    throw dieline::DielineError(cli::withInputNamed(error.what(), file.path()));
  }
}

}  // namespace

int lintCommand(const std::vector<fs::path>& files, const std::string& piped, const fs::path& image,
                const DrawingChoice& drawings, const judge::RunOptions& options) {
  const scenario::ImagePath images{options.bin_dir.parent_path() / "firmware", image};
  int code = 0;
  const auto count = [&code](int one) { code = base::worstExitCode(code, one); };
  for (const fs::path& path : files) {
    try {
      const bool is_piped = cli::isStandardInput(path);
      const int found =
          is_piped ? lintPiped(piped, drawings, images, options) : lintFile(path, drawings, images, options);
      if (found == 0 && !options.quiet)
        say(fmt::format("{}: good", is_piped ? cli::kStandardInputName : path.string()));
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
