// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/head_check_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/version.h"
#include "hil/calibrate/head/quick_check.h"
#include "hil/head_service/head_procedure.h"
#include "hil/head_service/head_record.h"
#include "hil/head_service/sheet_by_hand.h"
#include "hil/head_service/sheet_on_twin.h"
#include "hil/instrument/head_exit.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::instrument {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kExitChanged = 1;
constexpr int kMarksEachWay = 3;
constexpr int kCheckSheet = 1000;  // Number of a sheet whose pictures have a noise of their own.

Json jsonOf(const calibrate::DriftFinding& drift) {
  return {{"name", calibrate::nameOf(drift.which)},
          {"unit", std::string(calibrate::unitOf(drift.which))},
          {"value", drift.value},
          {"sigma", drift.sigma},
          {"changed", drift.changed}};
}

std::string checkJson(const calibrate::QuickCheckResult& result, const head_service::HeadSetup& setup,
                      const head_service::MeasuredSheet& sheet, const std::string& command) {
  Json json{{"version", 1},
            {"kerfbench", base::version()},
            {"machine", setup.name},
            {"marks", sheet.marks.size()},
            {"missing", sheet.missing},
            {"false", sheet.false_marks},
            {"rejected", result.rejected},
            {"off_mm", head_service::errorsOf({&sheet, 1}).max_mm},
            {"off_from_fit_mm", result.worst_mm},
            {"holds", result.holds},
            {"unexplained", result.unexplained},
            {"words", result.words}};
  for (const calibrate::DriftFinding& drift : result.drifts) json["drifts"].push_back(jsonOf(drift));
  json["command"] = command;
  return json.dump(2) + "\n";
}

void tell(const calibrate::QuickCheckResult& result, const head_service::MeasuredSheet& sheet,
          base::Console& console) {
  console.say(fmt::format("  {} marks found, {} missing, {} false, {} rejected", sheet.marks.size(),
                          sheet.missing, sheet.false_marks, result.rejected));
  for (const std::string& remark : sheet.remarks) console.say("    " + remark);
  for (const calibrate::DriftFinding& drift : result.drifts) {
    console.say(fmt::format("  {:<18}{:+.6f} ± {:.6f}{}{}", calibrate::nameOf(drift.which), drift.value,
                            2.0 * drift.sigma, calibrate::unitOf(drift.which),
                            drift.changed ? ", changed" : ""));
  }
}

/// The table at work: told, or the machine's own, or the one that the calibration made.
fs::path tableAtWork(const HeadCheckOptions& options, const head_service::HeadSetup& setup,
                     const head_service::HeadRecord& record) {
  if (!options.table.empty()) return options.table;
  return setup.table_file.empty() ? record.table : setup.table_file;
}

head_service::MeasuredSheet sheetOf(const head_service::HeadSetup& setup, const HeadCheckOptions& options,
                                    const calibrate::MarkJob& job, const fs::path& table,
                                    base::Console& console) {
  if (!options.job.empty())
    return head_service::measurePictures(options.pictures, head_service::readJobOf(setup, options.job), setup,
                                         options.jobs);
  const head_service::TwinBench bench{.seed = options.seed,
                                      .imperfections = scenario::presetFromName(options.imperfections),
                                      .fidelity = scenario::fidelityFromName(options.twin),
                                      .bin_dir = options.bin_dir,
                                      .firmware = head_service::firmwareOf(options.image),
                                      .keep_pictures = options.keep_pictures,
                                      .threads = options.jobs};
  if (options.by_hand) {
    const head_service::SheetByHand by_hand(setup, bench, options.results_dir, options.command_line);
    return by_hand({.job = job, .table = head_service::readControllerTable(table)});
  }
  const auto progress = base::progressOn(console);
  return head_service::sheetOnTwin(setup, bench, {job, kCheckSheet, options.results_dir / job.name, table},
                                   progress)
      .measured;
}

int check(const HeadCheckOptions& options) {
  base::Console console(options.quiet);
  head_service::HeadSetup setup = head_service::readHeadSetup(options.machine, kDensest);
  const head_service::HeadRecord record = head_service::readHeadRecord(options.calibration, setup);
  setup.unmodelled_share = record.unmodelled_share;
  const fs::path table_file = tableAtWork(options, setup, record);
  const calibrate::AimGrid table = head_service::readControllerTable(table_file);
  fs::create_directories(options.results_dir);
  console.say(fmt::format("head of {}, kerf camera {}", setup.name, setup.camera.camera_id));
  console.say(fmt::format("  calibrated by {} marks in {}; the controller uses {}",
                          record.observations.size(), options.calibration.string(), table_file.string()));

  const calibrate::HeadFit calibrated = head_service::fitted(record.observations, setup).fit;
  head_service::HeadPlan plan;
  plan.date = setup.camera.date;
  const calibrate::MarkJob job = head_service::planSheet(
      setup, plan, "check", calibrate::gridPlaces(setup.field_W_mm, kMarksEachWay), 0);
  const head_service::MeasuredSheet sheet = sheetOf(setup, options, job, table_file, console);
  const calibrate::QuickCheckResult result =
      calibrate::quickCheck(calibrated, head_service::observationsOf(sheet, table, 0));
  tell(result, sheet, console);
  base::writeFileAtomically(options.results_dir / "check.json",
                            checkJson(result, setup, sheet, options.command_line));
  console.result(fmt::format("{}: {}; the beam is off by {:.4f} mm at most", setup.name, result.words,
                             head_service::errorsOf({&sheet, 1}).max_mm));
  return result.holds ? 0 : kExitChanged;
}

}  // namespace

int checkHeadCommand(const HeadCheckOptions& options) {
  return guardedHead(options.machine, "nothing is said of the head", [&] { return check(options); });
}

}  // namespace kerfbench::instrument
