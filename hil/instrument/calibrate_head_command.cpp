// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/calibrate_head_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/version.h"
#include "hil/calibrate/tables/csv_table.h"
#include "hil/head_service/head_on_twin.h"
#include "hil/head_service/head_procedure.h"
#include "hil/head_service/head_report.h"
#include "hil/head_service/service_steps.h"
#include "hil/head_service/sheet_by_hand.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/instrument/head_exit.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::instrument {
namespace {

namespace fs = std::filesystem;

// From so many on the fit takes nothing of the head's surface as told.
constexpr std::size_t kManyMarks = 40;
// Shares of the field that the job's marks span, along x and along y.
constexpr double kLeastReach = 0.9;

head_service::TwinBench benchOf(const HeadCalibrateOptions& options) {
  return {.seed = options.seed,
          .imperfections = scenario::presetFromName(options.imperfections),
          .fidelity = scenario::fidelityFromName(options.twin),
          .bin_dir = options.bin_dir,
          .firmware = head_service::firmwareOf(options.image),
          .keep_pictures = options.keep_pictures,
          .threads = options.jobs};
}

void tell(const head_service::MeasuredSheet& sheet, base::Console& console) {
  for (const std::string& remark : sheet.remarks) console.say("    " + remark);
}

void tell(const head_service::HeadIteration& iteration, base::Console& console) {
  const auto wanted = static_cast<int>(iteration.before.marks) + iteration.marks.missing;
  console.say(
      fmt::format("  {0} x {0}: {1} of {2} marks found, {3} false, {4} rejected; off by {5:.4f} mm at most, "
                  "{6:.4f} mm RMS",
                  iteration.grid, iteration.before.marks, wanted, iteration.marks.false_marks,
                  iteration.head.fit.rejected(), iteration.before.max_mm, iteration.before.rms_mm));
  tell(iteration.marks, console);
  console.say(
      fmt::format("    with the new table, at {} other places on {} sheet{}: {:.4f} mm at most, {:.4f} mm "
                  "RMS; {} within the 95 % stated",
                  iteration.after.marks, iteration.verified.size(), iteration.verified.size() == 1 ? "" : "s",
                  iteration.after.max_mm, iteration.after.rms_mm, iteration.table.covered));
  console.say(fmt::format("    anywhere in the field {:.4f} ± {:.4f} mm at most (k = 2)",
                          iteration.table.largest.value_mm, iteration.table.largest.U_mm));
  if (!iteration.spread.holds()) console.say("    " + iteration.spread.words());
  for (const head_service::MeasuredSheet& sheet : iteration.verified) tell(sheet, console);
}

void tellParameters(const calibrate::HeadFit& fit, base::Console& console) {
  console.say("  what the marks tell of the head (± U, k = 2):");
  for (const calibrate::HeadParameterFinding& finding : fit.parameters())
    if (finding.held) console.say("    " + head_service::parameterWords(finding));
  const auto held = std::ranges::count_if(fit.parameters(), &calibrate::HeadParameterFinding::held);
  console.say(
      fmt::format("    {} of {} parameters; the others are in head.json", held, fit.parameters().size()));
}

/// Keeps the table of an iteration, numbered from 1, whatever becomes of it.
void writeTable(const HeadCalibrateOptions& options, int number,
                const head_service::HeadIteration& iteration) {
  base::writeFileAtomically(options.results_dir / fmt::format("correction-{}.csv", number),
                            calibrate::csvTable(iteration.head.table.grid));
}

head_service::HeadOnTwin onTwin(const head_service::HeadSetup& setup, const HeadCalibrateOptions& options,
                                base::Console& console) {
  head_service::HeadOnTwin cut(setup, benchOf(options), options.results_dir);
  cut.progress = [&](const std::string& sheet, double now_s, const std::string& what) {
    console.progress(now_s, fmt::format("{}: {}", sheet, what));
  };
  cut.was_there = [&](const std::string& sheet) { console.say(fmt::format("  {}: measured before", sheet)); };
  return cut;
}

head_service::HeadPlan planOf(const HeadCalibrateOptions& options, const head_service::HeadSetup& setup) {
  return {.grids = options.grids,
          .verify = options.verify,
          .limit_mm = options.limit_mm,
          .date = options.date.empty() ? setup.camera.date : options.date,
          .seed = options.seed};
}

fs::path tableOf(const HeadCalibrateOptions& options) {
  return options.out.empty() ? options.results_dir / "correction.csv" : options.out;
}

/// Rejection flag of each mark, in the order of their numbers; the fit is of this sheet alone.
std::vector<int> rejectedOf(const head_service::MeasuredSheet& sheet, const calibrate::HeadFit& fit) {
  std::vector<int> numbers;
  for (std::size_t i = 0; i < sheet.marks.size(); ++i)
    if (!fit.marks()[i].used) numbers.push_back(sheet.marks[i].wanted.number);
  return numbers;
}

/// Says where, and what else was noticed on the sheet.
[[noreturn]] void refuse(const fs::path& pictures, const calibrate::MarkJob& job,
                         const head_service::MeasuredSheet& sheet, const std::string& text) {
  std::string all = fmt::format("{}: job {}: {}", pictures.string(), job.name, text);
  for (const std::string& remark : sheet.remarks) all += "\n  " + remark;
  throw head_service::HeadEvidenceError(all);
}

/// Nothing verifies a table of pictures alone: it must not reach far beyond the marks.
void requireReach(const fs::path& pictures, const calibrate::MarkJob& job,
                  const head_service::MeasuredSheet& sheet) {
  Eigen::AlignedBox2d wanted;
  Eigen::AlignedBox2d found;
  for (const calibrate::WantedMark& mark : job.marks) wanted.extend(mark.p_W_mm);
  for (const head_service::MeasuredMark& mark : sheet.marks) found.extend(mark.wanted.p_W_mm);
  std::string faults;
  for (const int axis : {0, 1}) {
    if (found.sizes()[axis] >= kLeastReach * wanted.sizes()[axis]) continue;
    faults += fmt::format(
        "\n  the marks found reach from {0} = {1:g} to {2:g} mm, those of the job from {3:g} to {4:g} mm",
        axis == 0 ? "x" : "y", found.min()[axis], found.max()[axis], wanted.min()[axis], wanted.max()[axis]);
  }
  if (faults.empty()) return;
  refuse(pictures, job, sheet, "a part of the field has no marks" + faults);
}

/// A table of few marks is as good as they allow. Many hold any head of this kind; where they leave a doubt
/// beyond the limit they lie as none would put them, and it is the pictures, or where they were taken.
void requireAgreement(const HeadCalibrateOptions& options, const calibrate::MarkJob& job,
                      const head_service::MeasuredSheet& sheet, const head_service::FittedHead& head) {
  const double off_mm = 2.0 * head.table.largest_sigma_mm;
  if (sheet.marks.size() < kManyMarks || off_mm <= options.limit_mm) return;
  refuse(
      options.pictures, job, sheet,
      fmt::format("{} marks do not agree on a head: the beam may be off by {:.4f} mm with their table, more "
                  "than the limit of {:g} mm",
                  sheet.marks.size(), off_mm, options.limit_mm));
}

head_service::HeadCalibration fitted(const head_service::HeadSetup& setup, const fs::path& pictures,
                                     const calibrate::MarkJob& job, const head_service::MeasuredSheet& sheet,
                                     const head_service::HeadPlan& plan) {
  try {
    return head_service::calibrateHeadOnce(setup, plan, sheet);
  } catch (const calibrate::HeadCalibrationError& error) {
    refuse(pictures, job, sheet, error.what());
  }
}

/// A sheet that was cut and photographed before.
head_service::HeadCalibration fromPictures(const head_service::HeadSetup& setup,
                                           const HeadCalibrateOptions& options, base::Console& console) {
  const calibrate::MarkJob job = head_service::readJobOf(setup, options.job);
  console.say(fmt::format("  job {}, pictures of {}", job.name, options.pictures.string()));
  const head_service::MeasuredSheet sheet =
      head_service::measurePictures(options.pictures, job, setup, options.jobs);
  tell(sheet, console);
  console.say(fmt::format("  {} of {} marks found", sheet.marks.size(), job.marks.size()));
  requireReach(options.pictures, job, sheet);
  head_service::HeadCalibration result = fitted(setup, options.pictures, job, sheet, planOf(options, setup));
  requireAgreement(options, job, sheet, result.iterations.front().head);
  const std::vector<int> left_out = rejectedOf(sheet, result.iterations.front().head.fit);
  if (!left_out.empty()) {
    console.say(fmt::format("    {} with all others and left out: {}",
                            left_out.size() == 1 ? "1 mark that disagrees"
                                                 : fmt::format("{} marks that disagree", left_out.size()),
                            fmt::join(left_out, ", ")));
  }
  return result;
}

/// From the results; absolute where it lies elsewhere.
std::string besideReport(const fs::path& file, const fs::path& results) {
  const fs::path from_results =
      fs::absolute(file).lexically_normal().lexically_relative(fs::absolute(results).lexically_normal());
  const bool beside = !from_results.empty() && *from_results.begin() != "..";
  return (beside ? from_results : fs::absolute(file).lexically_normal()).string();
}

std::vector<head_service::HeadFile> filesOf(const head_service::HeadCalibration& result,
                                            const HeadCalibrateOptions& options, const fs::path& table) {
  std::vector<head_service::HeadFile> files;
  if (result.good()) files.push_back({besideReport(table, options.results_dir), "the controller's table"});
  if (options.job.empty()) {
    for (std::size_t i = 1; i <= result.iterations.size(); ++i) {
      files.push_back({fmt::format("correction-{}.csv", i), fmt::format("the table of iteration {}", i)});
      files.push_back({fmt::format("{}-grid/", i), "its grid: job, drawing, scenario, measured marks"});
      for (std::size_t sheet = 1; sheet <= result.iterations[i - 1].verified.size(); ++sheet)
        files.push_back({fmt::format("{}-verify-{}/", i, sheet), "a sheet that verifies it"});
    }
  }
  files.push_back({"head.json", "all figures of this page"});
  return files;
}

head_service::HeadFacts factsOf(const head_service::HeadCalibration& result,
                                const head_service::HeadSetup& setup, const HeadCalibrateOptions& options,
                                const fs::path& table) {
  return {.machine = setup.name,
          .command = options.command_line,
          .version = base::version(),
          .camera = setup.camera.camera_id,
          .source = options.job.empty() ? fmt::format("twin {}, imperfections {}, seed {}", options.twin,
                                                      options.imperfections, options.seed)
                                        : options.pictures.string(),
          .mark_size_mm = setup.mark_size_mm,
          .field_W_mm = setup.field_W_mm,
          .unmodelled_share = setup.unmodelled_share,
          .table = setup.table,
          .files = filesOf(result, options, table)};
}

int conclude(const head_service::HeadCalibration& result, const head_service::HeadPlan& plan,
             const head_service::HeadSetup& setup, const HeadCalibrateOptions& options,
             base::Console& console) {
  const head_service::FittedHead& best = result.iterations.at(result.best).head;
  tellParameters(best.fit, console);
  const fs::path table = tableOf(options);
  const head_service::HeadFacts facts = factsOf(result, setup, options, table);
  if (result.good()) base::writeFileAtomically(table, calibrate::csvTable(best.table.grid));
  base::writeFileAtomically(options.results_dir / "head.json", head_service::headJson(result, plan, facts));
  base::writeFileAtomically(options.results_dir / "report.html", head_service::headHtml(result, plan, facts));
  console.result(fmt::format("{}: {}", setup.name, result.endWords(plan)));
  console.say(fmt::format("report: {}", (options.results_dir / "report.html").string()));
  if (!result.good()) {
    console.say(fmt::format("the best table is correction-{}.csv in {}; {} is not written", result.best + 1,
                            options.results_dir.string(), table.string()));
    return inspect::exitCode(result.verdict);
  }
  console.say(fmt::format("table: {} ({} x {} nodes); for the controller: controller: {{correction: {}}}",
                          table.string(), best.table.grid.x_mm().size(), best.table.grid.y_mm().size(),
                          table.filename().string()));
  return 0;
}

int calibrate(const HeadCalibrateOptions& options) {
  base::Console console(options.quiet);
  const bool cut = !options.job.empty();
  head_service::HeadSetup setup =
      head_service::readHeadSetup(options.machine, std::ranges::max(options.grids), options.table);
  setup.unmodelled_share = options.unmodelled_share;
  setup.scanner_file = options.scanner;
  const head_service::HeadPlan plan = planOf(options, setup);
  fs::create_directories(options.results_dir);
  console.say(fmt::format("head of {}, kerf camera {}", setup.name, setup.camera.camera_id));
  if (cut) {
    const head_service::HeadCalibration result = fromPictures(setup, options, console);
    writeTable(options, 1, result.iterations.front());
    return conclude(result, plan, setup, options, console);
  }
  console.say(fmt::format("  marks of {:g} mm over {:g} x {:g} mm", setup.mark_size_mm,
                          setup.field_W_mm.sizes().x(), setup.field_W_mm.sizes().y()));
  head_service::ServiceSteps steps({.kind = "calibrate head",
                                    .machine = setup.name,
                                    .camera = setup.camera.camera_id,
                                    .date = plan.date,
                                    .command = options.command_line,
                                    .version = base::version()},
                                   options.results_dir);
  steps.follow(head_service::stepsAhead());
  const head_service::CutAndMeasure sheets =
      options.by_hand ? head_service::CutAndMeasure(head_service::SheetByHand(
                            setup, benchOf(options), options.results_dir, options.command_line, steps))
                      : head_service::CutAndMeasure(onTwin(setup, options, console));
  int iterations = 0;
  const head_service::HeadCalibration result =
      head_service::calibrateHead(setup, plan, sheets, [&](const head_service::HeadIteration& iteration) {
        tell(iteration, console);
        writeTable(options, ++iterations, iteration);
      });
  if (options.by_hand) {
    steps.follow(head_service::stepsAfter(result, plan, besideReport(tableOf(options), options.results_dir)));
    steps.ended(std::string(result.verdictName()), result.endWords(plan));
    steps.write();
  }
  return conclude(result, plan, setup, options, console);
}

}  // namespace

int calibrateHeadCommand(const HeadCalibrateOptions& options) {
  return guardedHead(options.machine, "no table is written", [&] { return calibrate(options); });
}

}  // namespace kerfbench::instrument
