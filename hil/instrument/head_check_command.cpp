// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/head_check_command.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/digest.h"
#include "hil/base/version.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/day.h"
#include "hil/calibrate/head/quick_check.h"
#include "hil/head_service/check_history.h"
#include "hil/head_service/check_report.h"
#include "hil/head_service/head_procedure.h"
#include "hil/head_service/head_record.h"
#include "hil/head_service/service_steps.h"
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
          {"U", 2.0 * drift.sigma},
          {"changed", drift.changed}};
}

std::string checkJson(const calibrate::QuickCheckResult& result, const head_service::HeadSetup& setup,
                      const head_service::MeasuredSheet& sheet, const std::string& date,
                      const std::string& command) {
  Json json{{"version", 1},
            {"kerfbench", base::version()},
            {"machine", setup.name},
            {"date", date},
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
  return json.dump(2, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
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

/// Day of the check. A real one is today's, and pictures are of today unless it is told otherwise; the twin's
/// days are those of its files, so that the same command writes the same bytes.
std::string dayOf(const HeadCheckOptions& options, const head_service::HeadSetup& setup) {
  if (!options.date.empty()) {
    if (!calibrate::dayNumber(options.date))
      throw base::ConfigError(fmt::format("--date: {} is no day like 2026-11-21", options.date));
    return options.date;
  }
  if (!options.by_hand && options.job.empty()) return setup.camera.date;
  return fmt::format("{:%Y-%m-%d}",
                     fmt::localtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

head_service::MeasuredSheet sheetOf(const head_service::HeadSetup& setup, const HeadCheckOptions& options,
                                    const calibrate::MarkJob& job, const fs::path& table,
                                    base::Console& console, head_service::ServiceSteps& steps) {
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
    const head_service::SheetByHand by_hand(setup, bench, options.results_dir, options.command_line, steps);
    return by_hand({.job = job, .table = head_service::readControllerTable(table)});
  }
  const auto progress = base::progressOn(console);
  return head_service::sheetOnTwin(setup, bench, {job, kCheckSheet, options.results_dir / job.name, table},
                                   progress)
      .measured;
}

std::vector<head_service::ServiceStep> stepsOfCheck(const calibrate::QuickCheckResult* result) {
  using State = head_service::ServiceStep::State;
  head_service::ServiceStep verdict{"verdict", "", "Held against the calibration: does the correction hold?"};
  head_service::ServiceStep act{"act", "", "If it does not hold: mend what changed, or calibrate again"};
  if (result == nullptr) return {verdict, act};
  verdict.state = State::kDone;
  verdict.files = {{"check.html", "the check, with the trend over all checks"}};
  (result->holds ? verdict.found : verdict.wrong) = {result->words};
  act.state = result->holds ? State::kDone : State::kNow;
  if (!result->holds)
    act.text = {
        "A zero that moved alone may be the sheet's place: lay another one and check again. Gains and turn "
        "are "
        "the head's: ./bench calibrate head --by-hand."};
  return {verdict, act};
}

/// Keeps the check, and writes what is made of it.
void conclude(const calibrate::QuickCheckResult& result, const head_service::MeasuredSheet& sheet,
              const head_service::HeadSetup& setup, const HeadCheckOptions& options, const fs::path& table) {
  head_service::HeadCheckRecord record = head_service::recordOf(result);
  record.date = dayOf(options, setup);
  record.machine = setup.name;
  record.calibration = base::sha256File(options.calibration / "head.json");
  record.sheet = base::sha256(head_service::measuredText(sheet));
  record.off_mm = head_service::errorsOf({&sheet, 1}).max_mm;
  const fs::path kept = options.history.empty() ? options.results_dir / "checks.jsonl" : options.history;
  const auto history = head_service::addToCheckHistory(kept, record);
  const head_service::CheckFacts facts{.machine = setup.name,
                                       .camera = setup.camera.camera_id,
                                       .date = record.date,
                                       .command = options.command_line,
                                       .version = base::version(),
                                       .calibration = options.calibration.string(),
                                       .table = table.string(),
                                       .limit_mm = options.limit_mm,
                                       .field_W_mm = setup.field_W_mm};
  base::writeFileAtomically(options.results_dir / "check.json",
                            checkJson(result, setup, sheet, record.date, options.command_line));
  base::writeFileAtomically(
      options.results_dir / "check.html",
      head_service::checkHtml(result, sheet, head_service::comparable(history, record), facts));
}

/// Nine marks with the table that is in use.
calibrate::MarkJob jobOf(const head_service::HeadSetup& setup) {
  head_service::HeadPlan plan;
  plan.date = setup.camera.date;
  return head_service::planSheet(setup, plan, "check", calibrate::gridPlaces(setup.field_W_mm, kMarksEachWay),
                                 0);
}

int check(const HeadCheckOptions& options) {
  base::Console console(options.quiet);
  head_service::HeadSetup setup = head_service::readHeadSetup(options.machine, kDensest);
  const std::string date = dayOf(options, setup);
  const head_service::HeadRecord record = head_service::readHeadRecord(options.calibration, setup);
  setup.unmodelled_share = record.unmodelled_share;
  setup.scanner_file = options.scanner;
  const fs::path table_file = tableAtWork(options, setup, record);
  const calibrate::AimGrid table = head_service::readControllerTable(table_file);
  fs::create_directories(options.results_dir);
  console.say(fmt::format("head of {}, kerf camera {}", setup.name, setup.camera.camera_id));
  console.say(fmt::format("  calibrated by {} marks in {}; the controller uses {}",
                          record.observations.size(), options.calibration.string(), table_file.string()));
  head_service::ServiceSteps steps(
      {"calibrate check", setup.name, setup.camera.camera_id, date, options.command_line, base::version()},
      options.results_dir);
  steps.follow(stepsOfCheck(nullptr));
  const calibrate::HeadFit calibrated = head_service::fitted(record.observations, setup).fit;
  const head_service::MeasuredSheet sheet = sheetOf(setup, options, jobOf(setup), table_file, console, steps);
  const calibrate::QuickCheckResult result =
      calibrate::quickCheck(calibrated, head_service::observationsOf(sheet, table, 0));
  tell(result, sheet, console);
  conclude(result, sheet, setup, options, table_file);
  if (options.by_hand) {
    steps.follow(stepsOfCheck(&result));
    steps.ended(result.holds ? "HOLDS" : "DOES NOT HOLD", result.words);
    steps.write();
  }
  console.result(fmt::format("{}: {}; the beam is off by {:.4f} mm at most", setup.name, result.words,
                             head_service::errorsOf({&sheet, 1}).max_mm));
  console.say(fmt::format("report: {}", (options.results_dir / "check.html").string()));
  return result.holds ? 0 : kExitChanged;
}

}  // namespace

int checkHeadCommand(const HeadCheckOptions& options) {
  return guardedHead(options.machine, "nothing is said of the head", [&] { return check(options); });
}

}  // namespace kerfbench::instrument
