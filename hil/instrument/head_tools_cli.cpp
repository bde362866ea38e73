// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "hil/instrument/cli.h"
#include "hil/instrument/head_check_command.h"
#include "hil/instrument/reversal_command.h"
#include "hil/instrument/scanner_command.h"
#include "hil/instrument/table_command.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::instrument {
namespace {

const std::vector<std::string> kTableFormats{"csv", "c-header", "cor1", "cor2", "grid-text", "nine-points"};

/// "33x17"
void readNodes(const std::string& text, TableCommandOptions& options) {
  const auto cross = text.find('x');
  const auto number = [](const std::string& digits) {
    const bool plain =
        !digits.empty() && digits.size() <= 4 && digits.find_first_not_of("0123456789") == std::string::npos;
    return plain ? std::stoi(digits) : 0;
  };
  options.columns = cross == std::string::npos ? 0 : number(text.substr(0, cross));
  options.rows = cross == std::string::npos ? 0 : number(text.substr(cross + 1));
  const auto good = [](int count) { return count >= 2 && count <= 1025; };
  if (!good(options.columns) || !good(options.rows))
    throw CLI::ValidationError("--nodes", "is to be COLUMNSxROWS, 2 to 1025 each");
}

/// What the formats leave open.
void addTableFormats(CLI::App& table, TableCommandOptions& o) {
  table.add_option("--cor", o.cor, "Whose convention a .cor follows, read or written")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kCorConventions), std::end(kCorConventions))))
      ->capture_default_str();
  table
      .add_option(
          "--units-per-mm", o.units_per_mm,
          "Of a .cor; otherwise read: the file's, written: 64 cells over the largest square in the table")
      ->check(CLI::PositiveNumber);
  table.add_option("--mm-per-index", o.mm_per_index, "Of nine points; otherwise the file's, or 2.5")
      ->check(CLI::PositiveNumber);
  table.add_flag("--int32", o.wide, "C header: values of 32 bits, in nm");
  table.add_option("--prefix", o.prefix, "C header: begin of all names")->capture_default_str();
}

/// What the twin is asked for; the same for all of these commands.
template <typename Options>
void addTwin(CLI::App& command, Options& o) {
  command.add_option("--seed", o.seed, "Of what the imperfections draw and of all noise")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9'000'000'000'000'000}))
      ->capture_default_str();
  command
      .add_option("--imperfections", o.imperfections,
                  "How far the machine is from its description: ideal, static, dynamic")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kPresetNames.begin(), scenario::kPresetNames.end())))
      ->capture_default_str();
  command.add_option("--twin", o.twin, "How the equations of motion are solved: reference or fast")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kFidelityNames.begin(), scenario::kFidelityNames.end())))
      ->capture_default_str();
  command.add_option("--jobs,-j", o.jobs, "Threads; the result is the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

void addCheck(CLI::App& calibrate, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<HeadCheckOptions>();
  HeadCheckOptions& o = *holder;
  o.bin_dir = program.bin_dir;
  o.command_line = program.command_line;
  o.jobs = program.jobs;
  o.calibration = program.results / "head";
  o.results_dir = program.results / "head-check";
  CLI::App* check = calibrate.add_subcommand("check",
                                             "Does a head's correction still hold? Nine marks are cut with "
                                             "it and held against the head as it was when\n"
                                             "`calibrate head` measured it; if something changed it says "
                                             "what: zeros, gains, turn, height of the sheet.\n"
                                             "Exit code 0: it holds; 1: it does not; 3: the marks cannot be "
                                             "trusted; 65: bad input; 75: by hand, waiting.");
  check->add_option("--machine", o.machine, "Machine file")->required();
  check->add_option("--calibration", o.calibration, "Results of `calibrate head`")->capture_default_str();
  check->add_option("--results-dir", o.results_dir, "Folder of this check")->capture_default_str();
  check->add_option("--cut-with", o.table,
                    "Table that the controller uses; otherwise the machine file's, or the calibration's");
  addTwin(*check, o);
  check->add_option(
      "--date", o.date,
      "Day of the check, like 2026-11-21; otherwise today, on the twin that of the kerf camera's "
      "calibration");
  check->add_option("--limit-mm", o.limit_mm, "Error of the beam towards which drifts are followed")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  check->add_option("--history", o.history,
                    "Checks so far, to which this one is added; otherwise checks.jsonl in the results");
  check->add_flag("--keep-pictures", o.keep_pictures, "Keep the pictures beside the job");
  CLI::Option* by_hand =
      check->add_flag("--by-hand", o.by_hand,
                      "The sheet is cut on a machine and photographed by people, as with `calibrate head`");
  check->add_option("--image", o.image, "By hand: release of the controller that cuts")->needs(by_hand);
  check
      ->add_option("--scanner", o.scanner,
                   "By hand: calibration of the scanner (calibrate scanner) for sheets that are scanned")
      ->needs(by_hand);
  CLI::Option* job =
      check->add_option("--job", o.job, "From pictures alone: the job (marks.yaml) that was cut");
  CLI::Option* pictures =
      check->add_option("--pictures", o.pictures, "Its pictures: a folder with tiles.yaml")->needs(job);
  job->needs(pictures)->excludes(by_hand);
  check->add_flag("--quiet,-q", o.quiet, "Only the result");
  actions.add(check, std::move(holder), checkHeadCommand);
}

void addReversal(CLI::App& calibrate, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<ReversalCommandOptions>();
  ReversalCommandOptions& o = *holder;
  o.bin_dir = program.bin_dir;
  o.command_line = program.command_line;
  o.jobs = program.jobs;
  o.results_dir = program.results / "head-reversal";
  CLI::App* reversal =
      calibrate.add_subcommand("reversal",
                               "Which part of a head's error is the camera's own? A sheet of marks is cut "
                               "once, photographed, turned on the\n"
                               "camera's table and photographed again: what turns with the sheet is the "
                               "head's, what stays is the camera's.\n"
                               "Exit code 0; 3: the pictures cannot be trusted; 65: bad input.");
  reversal->add_option("--machine", o.machine, "Machine file")->required();
  reversal->add_option("--results-dir", o.results_dir, "Folder of the results")->capture_default_str();
  reversal
      ->add_option("--turns", o.turns_deg,
                   "By how many degrees the sheet is turned, counter-clockwise, in the views after the first")
      ->delimiter(',')
      ->expected(1, 8)
      ->check(CLI::Range(-180.0, 180.0))
      ->capture_default_str();
  CLI::Option* grid = reversal->add_option("--grid", o.grid, "Marks each way")
                          ->check(CLI::Range(3, 17))
                          ->capture_default_str();
  reversal->add_option("--cut-with", o.table,
                       "Table that the controller uses; otherwise the machine file's, if any");
  addTwin(*reversal, o);
  CLI::Option* keep =
      reversal->add_flag("--keep-pictures", o.keep_pictures, "Keep the pictures of each view beside the job");
  CLI::Option* job =
      reversal->add_option("--job", o.job, "From pictures alone: the job (marks.yaml) that was cut")
          ->excludes(grid)
          ->excludes(keep);
  CLI::Option* pictures =
      reversal
          ->add_option(
              "--pictures", o.pictures,
              "Its pictures, folders with tiles.yaml: as the sheet lies first, then one for each of --turns")
          ->needs(job);
  job->needs(pictures);
  reversal->add_flag("--quiet,-q", o.quiet, "Only the result");
  actions.add(reversal, std::move(holder), reversalCommand);
}

void addTable(CLI::App& calibrate, cli::CliActions& actions) {
  auto holder = std::make_shared<TableCommandOptions>();
  TableCommandOptions& o = *holder;
  CLI::App* table = calibrate.add_subcommand(
      "table",
      "Tell what a file of correction is, hold it against nine marks, write it in another format.\n"
      "docs/reference/formats.md has the formats and their conventions. Exit code 0; with --check 1: not to "
      "be\n"
      "used as it is, 4: the marks cannot tell; nothing is written then. 65: bad input.");
  table->add_option("FILE", o.file, "Table")->required();
  table->add_option("--format", o.format, "Of FILE; otherwise by its content")
      ->check(CLI::IsMember(kTableFormats));
  CLI::Option* check = table->add_option("--check", o.check,
                                         "Nine points as measured without any correction (ix iy x_wrong_mm "
                                         "y_wrong_mm): which way round is the table?");
  table->add_option("--sigma-mm", o.sigma_mm, "Standard deviation of a coordinate of --check")
      ->needs(check)
      ->check(CLI::Range(1e-5, 1.0))
      ->capture_default_str();
  CLI::Option* out = table->add_option("--out", o.out, "Write the table there, righted if --check says so");
  table->add_option("--to", o.to, "Format of --out")
      ->needs(out)
      ->check(CLI::IsMember(kTableFormats))
      ->capture_default_str();
  table
      ->add_option_function<std::string>(
          "--nodes", [&o](const std::string& text) { readNodes(text, o); },
          "Of --out, as COLUMNSxROWS; otherwise those of the table, or of its format")
      ->type_name("CxR")
      ->needs(out);
  addTableFormats(*table, o);
  table->add_flag("--quiet,-q", o.quiet, "Only what was found and written");
  actions.add(table, std::move(holder), calibrateTableCommand);
}

void addScanner(CLI::App& calibrate, cli::CliActions& actions) {
  auto holder = std::make_shared<ScannerCommandOptions>();
  ScannerCommandOptions& o = *holder;
  CLI::App* scanner = calibrate.add_subcommand(
      "scanner",
      "Calibrate a flatbed scanner by one scan of the target: both scales, skew, bar, wobble of the "
      "carriage. Sheets\n"
      "that `calibrate head --by-hand` asks for can then be scanned in place of being photographed.\n"
      "Exit code 65: the scan is refused, nothing is written.");
  scanner->add_option("--scan", o.scan, "Picture of the whole glass, the target face down on it")->required();
  scanner->add_option("--target", o.target, "Description of the target (calibrate target writes it)")
      ->required();
  scanner->add_option("--dpi", o.dpi, "Resolution that was asked of the scanner")
      ->check(CLI::Range(100.0, 4800.0))
      ->capture_default_str();
  scanner->add_option("--date", o.date, "Day of the scan, like 2026-11-21")->required();
  scanner->add_option("--id", o.id, "Name of the scanner; otherwise that of --out");
  scanner->add_option("--out", o.out, "Calibration file")->capture_default_str();
  scanner->add_flag("--quiet,-q", o.quiet, "Only the result");
  actions.add(scanner, std::move(holder), calibrateScannerCommand);
}

}  // namespace

void addHeadTools(CLI::App& calibrate, const cli::CliProgram& program, cli::CliActions& actions) {
  addCheck(calibrate, program, actions);
  addReversal(calibrate, program, actions);
  addTable(calibrate, actions);
  addScanner(calibrate, actions);
}

}  // namespace kerfbench::instrument
