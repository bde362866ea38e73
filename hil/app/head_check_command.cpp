// SPDX-License-Identifier: Apache-2.0
#include "hil/app/head_check_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/app/commands.h"
#include "hil/app/console.h"
#include "hil/app/head_exit.h"
#include "hil/app/head_procedure.h"
#include "hil/app/head_record.h"
#include "hil/app/scenario.h"
#include "hil/app/sheet_by_hand.h"
#include "hil/app/sheet_on_twin.h"
#include "hil/base/atomic_file.h"
#include "hil/calibrate/head/quick_check.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kExitChanged = 1;
constexpr int kMarksEachWay = 3;
constexpr int kSheet = 1000;  // Its pictures have another noise than those of the calibration.
constexpr int kDensest = 17;  // As `calibrate head` has it: the same size of marks.

Json jsonOf(const DriftFinding& drift) {
  return {{"name", nameOf(drift.which)},
          {"unit", std::string(unitOf(drift.which))},
          {"value", drift.value},
          {"sigma", drift.sigma},
          {"changed", drift.changed}};
}

std::string checkJson(const QuickCheckResult& result, const HeadSetup& setup, const MeasuredSheet& sheet,
                      const std::string& command) {
  Json json{{"version", 1},
            {"kerfbench", KERFBENCH_VERSION},
            {"machine", setup.name},
            {"marks", sheet.marks.size()},
            {"missing", sheet.missing},
            {"false", sheet.false_marks},
            {"rejected", result.rejected},
            {"off_mm", errorsOf({&sheet, 1}).max_mm},
            {"off_from_fit_mm", result.worst_mm},
            {"holds", result.holds},
            {"unexplained", result.unexplained},
            {"words", result.words}};
  for (const DriftFinding& drift : result.drifts) json["drifts"].push_back(jsonOf(drift));
  json["command"] = command;
  return json.dump(2) + "\n";
}

void tell(const QuickCheckResult& result, const MeasuredSheet& sheet, Console& console) {
  console.say(fmt::format("  {} marks found, {} missing, {} false, {} rejected", sheet.marks.size(),
                          sheet.missing, sheet.false_marks, result.rejected));
  for (const std::string& remark : sheet.remarks) console.say("    " + remark);
  for (const DriftFinding& drift : result.drifts) {
    console.say(fmt::format("  {:<18}{:+.6f} ± {:.6f}{}{}", nameOf(drift.which), drift.value, drift.sigma,
                            unitOf(drift.which), drift.changed ? ", changed" : ""));
  }
}

/// The table at work: told, or the machine's own, or the one that the calibration made.
fs::path tableAtWork(const HeadCheckOptions& options, const HeadSetup& setup, const HeadRecord& record) {
  if (!options.table.empty()) return options.table;
  return setup.table_file.empty() ? record.table : setup.table_file;
}

MeasuredSheet sheetOf(const HeadSetup& setup, const HeadCheckOptions& options, const MarkJob& job,
                      const fs::path& table, Console& console) {
  if (!options.job.empty())
    return measurePictures(options.pictures, readJobOf(setup, options.job), setup, options.jobs);
  const TwinBench bench{.seed = options.seed,
                        .imperfections = presetFromName(options.imperfections),
                        .fidelity = fidelityFromName(options.twin),
                        .bin_dir = options.bin_dir,
                        .firmware = firmwareOf(options.image),
                        .keep_pictures = options.keep_pictures,
                        .threads = options.jobs};
  if (options.by_hand) {
    const SheetByHand by_hand(setup, bench, options.results_dir, options.command_line);
    return by_hand({.job = job, .table = readControllerTable(table)});
  }
  const auto progress = progressOn(console);
  return sheetOnTwin(setup, bench, {job, kSheet, options.results_dir / job.name, table}, progress).measured;
}

int check(const HeadCheckOptions& options) {
  Console console(options.quiet);
  HeadSetup setup = readHeadSetup(options.machine, kDensest);
  const HeadRecord record = readHeadRecord(options.calibration, setup);
  setup.unmodelled_share = record.unmodelled_share;
  const fs::path table_file = tableAtWork(options, setup, record);
  const AimGrid table = readControllerTable(table_file);
  fs::create_directories(options.results_dir);
  console.say(fmt::format("head of {}, kerf camera {}", setup.name, setup.camera.camera_id));
  console.say(fmt::format("  calibrated by {} marks in {}; the controller uses {}",
                          record.observations.size(), options.calibration.string(), table_file.string()));

  const HeadFit calibrated = fitted(record.observations, setup).fit;
  HeadPlan plan;
  plan.date = setup.camera.date;
  const MarkJob job = planSheet(setup, plan, "check", gridPlaces(setup.field_W_mm, kMarksEachWay), 0);
  const MeasuredSheet sheet = sheetOf(setup, options, job, table_file, console);
  const QuickCheckResult result = quickCheck(calibrated, observationsOf(sheet, table, 0));
  tell(result, sheet, console);
  writeFileAtomically(options.results_dir / "check.json",
                      checkJson(result, setup, sheet, options.command_line));
  console.result(fmt::format("{}: {}; the beam is off by {:.4f} mm at most", setup.name, result.words,
                             errorsOf({&sheet, 1}).max_mm));
  return result.holds ? 0 : kExitChanged;
}

}  // namespace

int checkHeadCommand(const HeadCheckOptions& options) {
  return guardedHead(options.machine, "nothing is said of the head", [&] { return check(options); });
}

}  // namespace kerfbench::hil
