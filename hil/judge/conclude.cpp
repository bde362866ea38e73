// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/conclude.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/version.h"
#include "hil/judge/judge.h"
#include "hil/judge/machine_pictures.h"
#include "hil/judge/model_parting.h"
#include "hil/judge/moments.h"
#include "hil/judge/real_spot.h"
#include "hil/judge/run_folder.h"
#include "hil/report/run_report.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {
namespace {

std::string checkLine(const inspect::Check& check) {
  const std::string subject = check.subject.empty() ? "" : " (" + check.subject + ")";
  return fmt::format("  {:<10} {:<14} {}, limit {}{}{}", inspect::verdictName(check.verdict), check.name,
                     report::checkNumber(check, check.value), check.upper ? "" : "at least ",
                     report::checkNumber(check, check.limit), subject);
}

// What the run was made with, and what the model alone knows. It tells people why; nothing of it is judged.
report::ModelFacts modelFacts(const scenario::Scenario& scenario, const run::ModelTruth& truth) {
  report::ModelFacts facts;
  facts.imperfections = scenario::nameOf(scenario.imperfections);
  facts.twin = scenario::nameOf(scenario.fidelity);
  for (const twin::Imperfection& sampled : truth.imperfections)
    facts.sampled.push_back({sampled.name, sampled.value, sampled.unit});
  for (const twin::LostSteps& lost : truth.lost_steps) {
    facts.lost_steps.push_back(
        {lost.axis, lost.time_s, lost.place, lost.axis.starts_with("galvo") ? "rad" : "mm", lost.full_steps});
  }
  return facts;
}

report::RunReport reportOf(const scenario::Case& test_case, const run::RecordedRun& run,
                           const Conclusion& conclusion, const RunOptions& options) {
  const scenario::Scenario& scenario = test_case.scenario;
  report::RunReport report;
  report.scenario = scenario.name;
  report.scenario_path = scenario.path.string();
  report.scenario_text = scenario.text;
  report.machine = test_case.machine.name;
  report.firmware = conclusion.firmware;
  report.source_id = conclusion.source_id;
  report.repeat_command = options.command_line;
  report.serial_number = options.serial_number;
  report.seed = scenario.seed;
  report.virtual_s = run.recording.rate.seconds(run.recording.end);
  report.versions = {{"kerfbench", base::version()}};
  if (!conclusion.firmware_sha256.empty())
    report.versions.emplace_back("firmware sha256", conclusion.firmware_sha256);
  if (!conclusion.firmware_version.empty())
    report.versions.emplace_back("controller", conclusion.firmware_version);
  if (!conclusion.remarks.empty())
    report.versions.emplace_back("firmware's words", fmt::format("{}", fmt::join(conclusion.remarks, " ")));
  if (!test_case.witness.empty()) report.versions.emplace_back("drawing", test_case.witness);
  for (const std::filesystem::path& input : test_case.inputs) {
    report.inputs.push_back(
        {input.lexically_relative(scenario.path.parent_path()).generic_string(), base::sha256File(input)});
  }
  report.limits = scenario.limits;
  report.dieline = test_case.dieline;
  report.accepted = scenario.accepted;
  report.print = scenario.print;
  const bool real_pictures = scenario.cameras.spot.is_real || !scenario.cameras.kerf.tiles.empty();
  report.model_pictures = scenario.firmware.onRealPins() && !real_pictures;
  report.unsealed = conclusion.unsealed;
  report.calibration_max_age_days = scenario.calibration_max_age_days;
  report.calibrations_undated = real_pictures && scenario.date.empty();
  return report;
}

/// Returns the sum with which the file of the pins ends.
std::string writePins(const std::filesystem::path& folder, const scenario::Case& test_case,
                      const run::RecordedRun& run, const Conclusion& conclusion) {
  std::string sum = source::writeVcd(folder / "pins.vcd", run.recording, test_case.machine.signals);
  base::writeFileAtomically(folder / "scenario.yaml", test_case.scenario.text);
  if (!conclusion.gcode.empty()) base::writeFileAtomically(folder / kJobFile, conclusion.gcode);
  return sum;
}

void tellVerdict(const report::RunReport& report, base::Console& console) {
  for (const std::string& line : report::diagnosisLines(report)) console.result("  " + line);
  for (const inspect::Check& check : report.result.checks) console.say(checkLine(check));
  if (!report.model.lost_steps.empty()) console.result("  " + report::lostStepsSentence(report.model));
  if (const std::string stop = report::stopSentence(report.result); !stop.empty())
    console.result("  " + stop);
  for (const std::string& problem : report.result.problems) console.result("  INVALID: " + problem);
  for (const inspect::Unjudged& unjudged : report.result.unjudged) {
    if (unjudged.applies)
      console.say(fmt::format("  {:<10} {:<14} {}", "not judged", unjudged.name, unjudged.reason));
  }
  const std::string but = report::reservationsLine(report);
  console.result(fmt::format("{}: {}{}", report.scenario, inspect::verdictName(report.result.verdict),
                             but.empty() ? "" : " (" + but + ")"));
  console.event("verdict", {{"verdict", std::string(inspect::verdictName(report.result.verdict))},
                            {"exit_code", std::int64_t{inspect::exitCode(report.result.verdict)}}});
}

void tellReport(const report::Digests& digests, const std::filesystem::path& folder, base::Console& console) {
  console.say(fmt::format("report: {}", (folder / "report.html").string()));
  console.say(fmt::format("digest: {}", digests.results));
  console.say(fmt::format("inputs: {}", digests.inputs));
  console.event("results", {{"folder", folder.string()}, {"digest", digests.results}});
}

void tellTiming(const base::Stopwatch& stopwatch, double virtual_s, base::Console& console) {
  for (const base::StageTime& stage : stopwatch.stages()) {
    console.result(fmt::format("  {:7.2f} s  {}", stage.wall_s, stage.stage));
  }
  console.result(fmt::format("  {:7.2f} s  in all for {:.3f} simulated s: {:.2f} s/s", stopwatch.total_s(),
                             virtual_s, stopwatch.total_s() / virtual_s));
}

}  // namespace

int conclude(const scenario::Case& test_case, const run::RecordedRun& run, const Conclusion& conclusion,
             const RunOptions& options, base::Stopwatch& stopwatch, base::Console& console) {
  report::RunReport report = reportOf(test_case, run, conclusion, options);
  std::string diagnosis_evidence;
  if (conclusion.safe_state) {
    report.provoked = true;
    addJudgement(judgeSafeState(test_case, run, *conclusion.safe_state), report);
  } else {
    const Cameras cameras{*conclusion.machine, conclusion.spot_frames, options.jobs, conclusion.spot_watch,
                          conclusion.kerf_watch};
    Judgement judgement = judge(test_case, run, conclusion.words, cameras,
                                {stopwatch, base::progressOn(console), options.keep_evidence});
    diagnosis_evidence = std::move(judgement.diagnosis_evidence);
    addJudgement(std::move(judgement), report);
  }
  addMoments(run.recording, test_case.machine.signals, conclusion.gcode, report);
  const run::ModelTruth truth = conclusion.machine->truth();
  report.model = modelFacts(test_case.scenario, truth);
  if (test_case.scenario.cameras.spot.is_real)
    report.model.partings = spotPartings(report.spot, truth.exposures, report.result.cuts);

  RunFolder folder(options.results_dir, conclusion.folder_name, options.output);
  report.evidence.insert(report.evidence.begin(),
                         {"pins", writePins(folder.staging(), test_case, run, conclusion)});
  if (!diagnosis_evidence.empty())
    base::writeFileAtomically(folder.staging() / "diagnosis-evidence.json", diagnosis_evidence);
  stopwatch.lap("recording of the pins");
  // Nobody waits for pictures and report: all that is judged is known.
  tellVerdict(report, console);
  if (options.pictures) {
    std::string trouble;
    report.pictures = writeMachinePictures(conclusion.machine->film(), test_case, conclusion.sampled->machine,
                                           folder.staging(), trouble);
    if (!trouble.empty()) console.say(trouble);
    stopwatch.lap("pictures of the machine");
  }
  report.timing = stopwatch.stages();
  const report::Digests digests = report::digestsOf(report);
  if (conclusion.finish_trace) {
    conclusion.finish_trace(report, digests, folder.staging());
    stopwatch.lap("trace");
  }
  report::writeReports(report, digests, folder.staging(), options.jobs);
  // Last, so that whatever fails before leaves them where they are.
  if (conclusion.moves_frames)
    std::filesystem::rename(conclusion.spot_frames, folder.staging() / kSpotFrames);
  folder.commit(std::chrono::system_clock::now(), digests.results);
  stopwatch.lap("report");

  tellReport(digests, folder.place(), console);
  if (options.timing) tellTiming(stopwatch, report.virtual_s, console);
  return inspect::exitCode(report.result.verdict);
}

int concludeUnrun(const scenario::Case& test_case, const std::string& folder_name,
                  const std::vector<std::string>& problems, const RunOptions& options,
                  base::Stopwatch& stopwatch, base::Console& console) {
  Conclusion conclusion;
  conclusion.firmware = "not run";
  report::RunReport report = reportOf(test_case, {}, conclusion, options);
  report.model = modelFacts(test_case.scenario, {});
  report.result.verdict = inspect::Verdict::kInvalid;
  report.result.problems = problems;
  RunFolder folder(options.results_dir, folder_name, options.output);
  base::writeFileAtomically(folder.staging() / "scenario.yaml", test_case.scenario.text);
  tellVerdict(report, console);
  report.timing = stopwatch.stages();
  const report::Digests digests = report::digestsOf(report);
  report::writeReports(report, digests, folder.staging(), options.jobs);
  folder.commit(std::chrono::system_clock::now(), digests.results);
  tellReport(digests, folder.place(), console);
  return inspect::exitCode(report.result.verdict);
}

}  // namespace kerfbench::judge
