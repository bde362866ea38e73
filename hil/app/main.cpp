// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/app/ci_variable.h"
#include "hil/app/cli.h"
#include "hil/app/desk_command.h"
#include "hil/app/diagnose_command.h"
#include "hil/app/fold_command.h"
#include "hil/app/lint_command.h"
#include "hil/app/motion_command.h"
#include "hil/app/other_program.h"
#include "hil/app/run_command.h"
#include "hil/app/verify_command.h"
#include "hil/base/exit_codes.h"
#include "hil/base/terminal.h"
#include "hil/cli/cli.h"
#include "hil/cli/program.h"
#include "hil/cli/standard_input.h"
#include "hil/judge/run_options.h"
#include "hil/scenario/scenario.h"

namespace {

namespace fs = std::filesystem;
using namespace kerfbench;
using namespace kerfbench::app;
using namespace kerfbench::cli;

std::shared_ptr<judge::RunOptions> commonOptions(const CliProgram& program) {
  auto options = std::make_shared<judge::RunOptions>();
  options->bin_dir = program.bin_dir;
  options->command_line = program.command_line;
  options->jobs = program.jobs;
  options->results_dir = program.results;
  options->pictures = !isCi(std::getenv("CI"));
  return options;
}

/// What is wrong with a serial number; empty: nothing.
std::string checkSerialNumber(const std::string& number) {
  constexpr std::size_t kLongest = 64;
  if (number.empty() || number.size() > kLongest) return fmt::format("has 1 to {} bytes", kLongest);
  for (const char c : number)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return "has a control character";
  return {};
}

void addCommonOptions(CLI::App& command, judge::RunOptions& options) {
  command.add_option("--results-dir", options.results_dir, "Folder for the results")->capture_default_str();
  command.add_option("--output", options.output,
                     "Folder for these results alone, not there yet, instead of one in --results-dir");
  command.add_option("--seed", options.seed,
                     "Seed of all noise and of what the imperfections draw, instead of the scenario's");
  command
      .add_option("--time-limit", options.time_limit_s,
                  "Seconds after which a run is INVALID: virtual ones, on real pins real ones")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--imperfections", options.imperfections,
                  "How far the machine is from its description: ideal, static (set-up),\n"
                  "dynamic (static, and lag, play, slip, flutter, noise); instead of the scenario's")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kPresetNames.begin(), scenario::kPresetNames.end())));
  command
      .add_option("--twin", options.twin,
                  "How the equations of motion are solved: reference (Bullet, step by step)\nor fast; "
                  "instead of the scenario's")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kFidelityNames.begin(), scenario::kFidelityNames.end())));
  command.add_option("--jobs,-j", options.jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  CLI::Option* const quiet = command.add_flag("--quiet,-q", options.quiet, "Only the verdict");
  command
      .add_flag("--verbose,-v", options.verbose,
                "Progress without a terminal as well: a line for each step, and one in ten seconds")
      ->excludes(quiet);
  command.add_option("--events", options.events,
                     "File to which a line of JSON is appended for each event of the run, as it happens");
  command
      .add_option("--serial-number", options.serial_number,
                  "What is tested: a word for report, verdict.json, junit.xml and history")
      ->check(checkSerialNumber);
  command.add_flag("--timing", options.timing, "Say where the time went");
  command.add_flag("--keep-evidence", options.keep_evidence,
                   "Keep what the diagnosis goes by, for kerfbench diagnose");
  CLI::Option* const with = command.add_flag(
      "--pictures", options.pictures,
      "Pictures of the machine in the report: they are there unless the environment variable\n"
      "CI is set, and neither empty nor false");
  command.add_flag("!--no-pictures", options.pictures, "No pictures of the machine in the report")
      ->excludes(with);
}

void addTraceOptions(CLI::App& command, judge::RunOptions& options) {
  CLI::Option* const trace = command.add_flag(
      "--trace", options.trace,
      "Write the run as one file for people, run.mcap (docs/reference/trace.md): poses, pins, commands,\n"
      "spot, frames, checks. While it goes on the file grows under the name that the run tells.");
  command
      .add_option("--trace-frames", options.trace_frames,
                  "Every Nth frame of the spot camera goes into the trace; 0: none")
      ->needs(trace)
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
}

void addImageOption(CLI::App& command, fs::path& image) {
  command.add_option("--image", image, "The release, instead of the scenario's firmware.image");
}

void addRun(CLI::App& app, const CliProgram& program, CliActions& actions) {
  CLI::App* run = app.add_subcommand(
      "run",
      "Run scenarios: firmware, machine, camera, verdict, report.\nA scenario on real pins (source: gpio, "
      "analyser) runs in real time; docs/how-to/real-pins.md has its keys.");
  const auto scenarios = std::make_shared<std::vector<fs::path>>();
  const auto image = std::make_shared<fs::path>();
  const auto options = commonOptions(program);
  run->add_option("SCENARIO", *scenarios, "Scenario files (fixtures/scenarios/*.yaml)")->required();
  addImageOption(*run, *image);
  addCommonOptions(*run, *options);
  addTraceOptions(*run, *options);
  run->final_callback([=] {
    if (!options->output.empty() && scenarios->size() > 1)
      throw CLI::ValidationError("--output", "is for one scenario");
  });
  actions.add(run, [=] { return runCommand(*scenarios, *image, *options); });
}

void addReplay(CLI::App& app, const CliProgram& program, CliActions& actions) {
  const auto files = std::make_shared<Replay>();
  const auto options = commonOptions(program);
  CLI::App* replay = app.add_subcommand("replay", "Judge recorded pins (pins.vcd, .sr) as if they were live");
  replay
      ->add_option("RECORDING", files->recording,
                   "VCD file with 1-bit wires named like galvo_x_pul,\nor a session file of sigrok (.sr), "
                   "channels named so or as the scenario's lines; - is standard input")
      ->required();
  replay->add_option("--scenario", files->scenario, "The scenario that was recorded")->required();
  addImageOption(*replay, files->image);
  replay->add_option("--frames", files->frames,
                     "Recording of the real spot camera that the scenario names;\notherwise the folder spot "
                     "beside the pins");
  addCommonOptions(*replay, *options);
  addTraceOptions(*replay, *options);
  actions.add(replay, [=] { return replayCommand(*files, *options); });
}

void addVerify(CLI::App& app, const CliProgram& program, CliActions& actions) {
  const auto options = std::make_shared<VerifyOptions>();
  options->run = *commonOptions(program);
  CLI::App* verify = app.add_subcommand(
      "verify",
      "Is a results folder what a run wrote? Compares its files with the sums in its list, the pins with\n"
      "their own, and with --scenario the verdict with what the pins give when they are judged again.\n"
      "Exit code 1: something differs. Whoever can write the folder can write all its sums anew: keep the\n"
      "digest elsewhere, and give it with --digest.");
  verify->add_option("FOLDER", options->folder, "Results folder of a run or of a replay")->required();
  verify->add_option("--scenario", options->scenario,
                     "The scenario of that run, with all files that it names as they were");
  addImageOption(*verify, options->image);
  verify->add_option("--frames", options->frames,
                     "Recording of the real spot camera that the scenario names;\notherwise the folder spot "
                     "in the results");
  verify->add_option("--digest", options->digest, "Digest that the verdict must have");
  verify->add_option("--jobs,-j", options->run.jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  verify->add_flag("--quiet,-q", options->run.quiet, "Only what differs, and the result");
  actions.add(verify, [=] { return verifyCommand(*options); });
}

void addMotion(CLI::App& app, const CliProgram& program, CliActions& actions) {
  const auto options = std::make_shared<MotionOptions>();
  options->bin_dir = program.bin_dir;
  CLI::App* motion = app.add_subcommand(
      "motion",
      "Where the pulses of a recording lead the head: a line for each cut, motion.csv with the place over "
      "time,\n"
      "pictures of the way in the machine, over the sheet, and of its length. Nothing is judged.");
  motion->add_option("RECORDING", options->recording, "pins.vcd of a run, or a recording as for replay")
      ->required();
  motion->add_option("--scenario", options->scenario, "The scenario that was recorded")->required();
  motion->add_option("--out", options->out, "Folder for table and pictures")->capture_default_str();
  motion->add_option("--every", options->every_s, "Time between the rows, s")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  motion->add_flag("--quiet,-q", options->quiet, "Only the files");
  actions.add(motion, [=] { return motionCommand(*options); });
}

void addDiagnose(CLI::App& app, CliActions& actions) {
  const auto files = std::make_shared<std::vector<fs::path>>();
  const auto as_json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "diagnose",
      "What is wrong with runs that did not pass, by the evidence that run or replay has kept\n"
      "(--keep-evidence): the causes again, by this version's diagnosis. Nothing is judged.");
  command->add_option("FILE", *files, "diagnosis-evidence.json of a results folder")->required();
  command->add_flag("--json", *as_json, "A line of JSON for each file");
  actions.add(command, [=] { return diagnoseCommand(*files, *as_json); });
}

void addFold(CLI::App& app, const CliProgram& program, CliActions& actions) {
  const auto options = std::make_shared<fold::FoldOptions>();
  options->out = program.results / "fold";
  options->command_line = program.command_line;
  options->jobs = program.jobs;
  CLI::App* command = app.add_subcommand(
      "fold",
      "Run five-axis cuts (X Y Z A C) over a folded blank: the model cuts it, its cameras look at it, and "
      "the\n"
      "distance of the cut's edge from the contour in space is judged; docs/how-to/fold-in-space.md.");
  command->add_option("SCENARIO", options->scenarios, "Scenario files (fixtures/fold/*.yaml)")->required();
  command
      ->add_option("--results-dir,-o", options->out,
                   "Folder for the results; of several scenarios each has one of its name in it")
      ->capture_default_str();
  command->add_option("--jobs,-j", options->jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("--quiet,-q", options->quiet, "Only the verdict");
  actions.add(command, [=] { return foldCommand(*options); });
}

void addLint(CLI::App& app, const CliProgram& program, CliActions& actions) {
  CLI::App* lint =
      app.add_subcommand("lint", "Check scenarios, machines (.yaml) and dielines (.dxf, .svg, .pdf, .cf2)");
  const auto files = std::make_shared<std::vector<fs::path>>();
  const auto image = std::make_shared<fs::path>();
  const auto options = commonOptions(program);
  const auto piped = std::make_shared<std::string>();
  lint->add_option("FILE", *files, "Files to check; - is standard input")->required();
  lint->add_option(
          "--format", *piped,
          "What comes on standard input: yaml, dxf, svg, pdf or cf2; otherwise told by how it begins")
      ->check(CLI::IsMember({"yaml", "dxf", "svg", "pdf", "cf2"}));
  addImageOption(*lint, *image);
  const auto drawings = std::make_shared<DrawingChoice>();
  lint->add_option("--scenario", drawings->scenario, "Read drawings by the rules of this scenario");
  addReadingOptions(*lint, drawings->arguments);
  lint->add_option("--accept", drawings->accepted,
                   "Faults that are accepted where they touch no cut: duplicate, overlap, gap, zero-length");
  lint->add_flag(
      "--witness", drawings->witness,
      "Have a second reader (ezdxf, svgelements, MuPDF) read the drawing too, and say where it parts:\n"
      "length and box of each layer and process, to 1 um");
  lint->add_flag("--quiet,-q", options->quiet, "Only what is wrong");
  const auto as_json = std::make_shared<bool>(false);
  lint->add_flag(
      "--json", *as_json,
      "Of scenarios: a line of JSON for each, with all that is wrong and its place, drawing and values");
  lint->final_callback([=] {
    const auto count = std::count_if(files->begin(), files->end(), isStandardInput);
    if (count > 1) throw CLI::ValidationError("FILE", "- can be given once");
    if (count == 0 && !piped->empty()) throw CLI::ValidationError("--format", "is for -, standard input");
  });
  actions.add(lint, [=, bin_dir = program.bin_dir] {
    if (*as_json) return checkCommand(*files, bin_dir);
    return lintCommand(*files, piped->empty() ? "" : "." + *piped, *image, *drawings, *options);
  });
}

/// Commands of other programs: only their names are here.
void addHandedOver(CLI::App& app, const CliProgram& program, CliActions& actions) {
  for (const HandedOver& each : kHandedOver)
    actions.handOver(app.add_subcommand(each.text.name, each.text.help), [program, each] {
      becomeProgram(program.bin_dir / each.program, each.text.name, program.argv);
    });
}

/// In the order of the help.
void addCommands(CLI::App& app, const CliProgram& program, CliActions& actions) {
  addRun(app, program, actions);
  addSuite(app, program, actions);
  addReplay(app, program, actions);
  addVerify(app, program, actions);
  addCampaign(app, program, actions);
  addHistory(app, program, actions);
  addTrace(app, program, actions);
  addMotion(app, program, actions);
  addDiagnose(app, actions);
  addFold(app, program, actions);
  addRecordFrames(app, program, actions);
  addCapture(app, program, actions);
  addLint(app, program, actions);
  addDesk(app, program, actions);
  addDoctor(app, program, actions);
  addShow(app, program, actions);
  addHandedOver(app, program, actions);
}

}  // namespace

int main(int argc, char** argv) {
  return guardedMain([argc, argv] {
    try {
      return dispatch(argc, argv, ProgramPart::kWhole, addCommands);
    } catch (const ProgramMissing& e) {
      base::toTerminal(stderr, fmt::format("{}\n", e.what()));
      return base::kExitBroken;
    }
  });
}
