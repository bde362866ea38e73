// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "hil/app/commands.h"
#include "hil/app/doctor_bench_cli.h"
#include "hil/app/head_tools_cli.h"
#include "hil/app/scenario.h"
#include "hil/base/freed_memory.h"

namespace {

namespace fs = std::filesystem;
using namespace kerfbench::hil;

std::string commandLine(int argc, char** argv) {
  std::string line = "./bench";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain = !word.empty() && word.find_first_of(" \t'\"$`\\*?;&|<>()") == std::string::npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

void addCommonOptions(CLI::App& command, CommonOptions& options) {
  command.add_option("--results-dir", options.results_dir, "Folder for the results")->capture_default_str();
  command.add_option("--seed", options.seed,
                     "Seed of all noise and of what the imperfections draw, instead of the scenario's");
  command.add_option("--time-limit", options.time_limit_s, "Virtual seconds after which a run is INVALID")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--imperfections", options.imperfections,
                  "How far the machine is from its description: ideal, static (set-up),\n"
                  "dynamic (static, and lag, play, slip, flutter, noise); instead of the scenario's")
      ->check(CLI::IsMember(std::vector<std::string>(kPresetNames.begin(), kPresetNames.end())));
  command
      .add_option("--twin", options.twin,
                  "How the equations of motion are solved: reference (Bullet, step by step)\nor fast; "
                  "instead of the scenario's")
      ->check(CLI::IsMember(std::vector<std::string>(kFidelityNames.begin(), kFidelityNames.end())));
  command.add_option("--jobs,-j", options.jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command.add_flag("--quiet,-q", options.quiet, "Only the verdict");
  command.add_flag("--timing", options.timing, "Say where the time went");
  command.add_flag("!--no-pictures", options.pictures,
                   "No pictures of the machine in the report: saves a few seconds");
}

// "1280x800"
std::string readSize(const std::string& text, ShowOptions& options) {
  const auto cross = text.find('x');
  const auto number = [](const std::string& digits) {
    const bool plain =
        !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string::npos;
    return plain ? std::stoi(digits) : 0;
  };
  options.width_px = cross == std::string::npos ? 0 : number(text.substr(0, cross));
  options.height_px = cross == std::string::npos ? 0 : number(text.substr(cross + 1));
  const bool good = std::min(options.width_px, options.height_px) >= 64 &&
                    std::max(options.width_px, options.height_px) <= 8192;
  return good ? "" : "is to be WIDTHxHEIGHT in pixels, 64 to 8192 each";
}

CLI::App* addShow(CLI::App& app, ShowOptions& options) {
  CLI::App* show = app.add_subcommand("show", "Draw a machine (PNG): at rest, or in the middle of a run");
  show->add_option("MACHINE", options.machine, "Machine file; may be left out where --scenario names it");
  CLI::Option* scenario =
      show->add_option("--scenario", options.scenario, "Run this, and draw the machine as it is then");
  show->add_option("--at", options.at_s,
                   "Virtual seconds, one or several; otherwise in the middle of the longest cut")
      ->needs(scenario)
      ->check(CLI::NonNegativeNumber);
  show->add_option("--out", options.out, "PNG file; several times are added to its name");
  show->add_option_function<std::string>(
          "--size",
          [&options](const std::string& text) {
            const std::string fault = readSize(text, options);
            if (!fault.empty()) throw CLI::ValidationError("--size", fault);
          },
          "Pixels, 1280x800 unless told")
      ->type_name("WxH");
  show->add_option("--view", options.view,
                   "overall, head (mirrors or carriage) or sheet (the board from above)")
      ->check(CLI::IsMember({"overall", "head", "sheet"}))
      ->capture_default_str();
  show->add_flag("--quiet,-q", options.quiet, "Only the names of the files");
  return show;
}

struct CalibrateCommands {
  CLI::App* all;
  CLI::App* camera;
  CLI::App* target;
  CLI::App* head;
};

void addWhichCamera(CLI::App& command, CalibrateOptions& options, bool required) {
  CLI::Option* machine = command.add_option("--machine", options.machine, "Machine file")->required(required);
  command
      .add_option("--camera", options.camera,
                  "spot (over the work plane) or kerf (over the inspection table)")
      ->check(CLI::IsMember({"spot", "kerf"}))
      ->required(required)
      ->needs(machine);
}

CLI::App* addCalibrateHead(CLI::App& calibrate, HeadCalibrateOptions& options) {
  CLI::App* head = calibrate.add_subcommand(
      "head",
      "Calibrate a scan head on the twin: marks are cut, found in the kerf camera's pictures, and the head "
      "is "
      "fitted;\n"
      "its correction table is verified at places that were never marked. docs/CALIBRATION.md says how.\n"
      "Exit code 0: the table is good; 1: not good enough; 3: the marks cannot be trusted; 65: bad input; "
      "75: by "
      "hand,\n"
      "waiting. In all but the first the table named by --out stays as it is. What is measured already is "
      "not done again.");
  head->add_option("--machine", options.machine, "Machine file")->required();
  head->add_option("--results-dir", options.results_dir, "Folder of this calibration; it goes on from there")
      ->capture_default_str();
  head->add_option("--grids", options.grids, "Marks each way, one iteration each")
      ->delimiter(',')
      ->expected(1, 3)
      ->check(CLI::Range(3, 33))
      ->capture_default_str();
  head->add_option("--verify", options.verify,
                   "Marks that verify each table, at random places, on as many sheets as they need")
      ->check(CLI::Range(5, 1000))
      ->capture_default_str();
  head->add_option("--limit-mm", options.limit_mm, "Largest error at any of them")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  head->add_option(
          "--unmodelled-share", options.unmodelled_share,
          "What encoders, lens and board may do that the head's parameters do not describe (1 sigma), "
          "as a share\nof the field's longer side: by their data sheets. It is in what is stated as "
          "long as fewer than 40 marks\nare measured; more of them tell it themselves")
      ->check(CLI::Range(1e-7, 0.1))
      ->capture_default_str();
  head->add_option("--seed", options.seed, "Of what the imperfections draw, of all noise and of the places")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9'000'000'000'000'000}))
      ->capture_default_str();
  head->add_option("--imperfections", options.imperfections,
                   "How far the machine is from its description: ideal, static, dynamic")
      ->check(CLI::IsMember(std::vector<std::string>(kPresetNames.begin(), kPresetNames.end())))
      ->capture_default_str();
  head->add_option("--twin", options.twin, "How the equations of motion are solved: reference or fast")
      ->check(CLI::IsMember(std::vector<std::string>(kFidelityNames.begin(), kFidelityNames.end())))
      ->capture_default_str();
  head->add_option("--date", options.date,
                   "Day of the jobs, like 2026-11-21; otherwise that of the kerf camera's calibration");
  head->add_option("--out", options.out, "The controller's table; otherwise correction.csv in the results");
  head->add_flag("--keep-pictures", options.keep_pictures, "Keep the pictures of each sheet beside its job");
  CLI::Option* by_hand =
      head->add_flag("--by-hand", options.by_hand,
                     "Sheets are cut on a machine and photographed by people: what they need is written into "
                     "the results and "
                     "said,\nexit code 75; run again when the pictures of a sheet are there");
  head->add_option("--image", options.image,
                   "By hand: release of the controller that cuts, such as controller-avr.hex; otherwise\n"
                   "controller-native-galvo")
      ->needs(by_hand);
  CLI::Option* job = head->add_option("--job", options.job,
                                      "From pictures alone: the job (marks.yaml) that was cut; no table is "
                                      "verified");
  CLI::Option* pictures =
      head->add_option("--pictures", options.pictures, "Its pictures: a folder with tiles.yaml")->needs(job);
  job->needs(pictures)->excludes(by_hand);
  head->add_option("--cut-with", options.table,
                   "Table that it was cut with; otherwise the one that the machine file names, if any")
      ->needs(job);
  head->add_option("--jobs,-j", options.jobs, "Threads; the result is the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  head->add_flag("--quiet,-q", options.quiet, "Only the result");
  return head;
}

CalibrateCommands addCalibrate(CLI::App& app, CalibrateOptions& options, HeadCalibrateOptions& head_options) {
  CLI::App* calibrate =
      app.add_subcommand("calibrate", "Calibrate a camera from pictures of a target, a scan head by marks");
  calibrate->require_subcommand(1);
  CLI::App* camera = calibrate->add_subcommand(
      "camera",
      "Calibrate a camera: lens, distortion, pose of its plane, and how sure of them it is.\n"
      "The first view has the target flat on the plane, over the whole picture; in the others it is tilted "
      "by\n"
      "20 to 40 degrees in several directions. Exit code 65: the views are refused, nothing is written.");
  addWhichCamera(*camera, options, true);
  camera->add_option("--date", options.date, "Day of the views, like 2026-11-21")->required();
  CLI::Option* views =
      camera->add_option("--views", options.views,
                         "Pictures (PNG of 8 or 16 bits), or a folder of them, in the order of their\n"
                         "names; without, the machine's twin takes them");
  camera->add_option("--target", options.target,
                     "Description of the target (calibrate target writes it);\n"
                     "without, the one that fits the camera");
  camera
      ->add_option("--origin-mm", options.origin_mm,
                   "First view: x y of the target's upper left corner of squares")
      ->expected(2)
      ->needs(views);
  camera->add_option("--turn-deg", options.turn_deg, "First view: from the plane's x to the target's")
      ->needs(views);
  camera->add_option("--seed", options.seed, "Of the noise in the twin's views")->excludes(views);
  camera->add_option("--tilted", options.tilted, "Tilted views of the twin")
      ->excludes(views)
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  camera
      ->add_option("--save-views", options.save_views, "Keep the twin's views and the target in this folder")
      ->excludes(views);
  camera->add_option("--max-rms-px", options.max_rms_px, "Refuse residuals above this")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  camera->add_option("--out", options.out, "Calibration file; otherwise where the machine file looks for it");
  camera->add_option("--residual-map", options.picture,
                     "SVG; otherwise MACHINE.CAMERA.residuals.svg in this folder");
  camera->add_option("--jobs,-j", options.jobs, "Threads; the result is the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  camera->add_flag("--quiet,-q", options.quiet, "Only the result");

  CLI::App* target =
      calibrate->add_subcommand("target", "Write a target to print (SVG) and its description (YAML)");
  target->add_option("--out", options.out, "SVG file; the description goes beside it")->required();
  addWhichCamera(*target, options, false);
  target->add_option("--columns", options.columns, "Squares; otherwise as fits the camera")
      ->check(CLI::Range(4, 200));
  target->add_option("--rows", options.rows, "Squares")->check(CLI::Range(4, 200));
  target->add_option("--square-mm", options.square_mm, "Side of a square")->check(CLI::Range(0.1, 1000.0));
  target->add_flag("--quiet,-q", options.quiet, "Nothing but what is wrong");
  return {calibrate, camera, target, addCalibrateHead(*calibrate, head_options)};
}

CLI::App* addGauge(CLI::App& app, GaugeCommandOptions& options) {
  CLI::App* gauge = app.add_subcommand(
      "gauge",
      "Prove the measuring instrument: artefacts with known deviation are cut on the model's sheet, looked "
      "at by\n"
      "the machine's cameras and judged as in a run; what was measured is compared with what is true.\n"
      "docs/GAUGE.md says how to read the result. Exit code 0: every claim holds or needs more cases; 1: "
      "one\n"
      "does not hold.");
  gauge->add_option("MACHINE", options.machine, "Machine file, whose cameras are gauged")
      ->capture_default_str();
  GaugeOptions& g = options.gauge;
  const auto count = CLI::Range(0, 1000000);
  CLI::Option* cases = gauge
                           ->add_option_function<std::size_t>(
                               "--cases", [&g](std::size_t each) { g.coverage = g.still = each; },
                               "Cases of coverage and of stillness, for each preset (1000)")
                           ->check(count);
  CLI::Option* bad = gauge->add_option("--bad", g.bad, "Cuts of 55 to 120 um, over all presets")
                         ->check(count)
                         ->capture_default_str();
  CLI::Option* good = gauge->add_option("--good", g.good, "Cuts of 0 to 40 um, over all presets")
                          ->check(count)
                          ->capture_default_str();
  gauge
      ->add_flag_function(
          "--quick",
          [&g](std::int64_t) {
            g.bad = g.good = 300;
            g.coverage = 60;
            g.still = 100;
            g.repeats = g.still_repeats = 25;
          },
          "300 bad and 300 good cuts and few others: two minutes; too few for what needs 1000 cases")
      ->excludes(cases)
      ->excludes(bad)
      ->excludes(good);
  gauge
      ->add_option_function<std::string>(
          "--imperfections",
          [&g](const std::string& which) {
            if (which != "both") g.presets = {presetFromName(which)};
          },
          "Machines to draw: ideal, static, dynamic or both (static and dynamic, the default)")
      ->check(CLI::IsMember({"ideal", "static", "dynamic", "both"}));
  gauge->add_option("--studies", options.studies, "Only these: verdicts, coverage, type1, grr, stillness")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kGaugeStudies.begin(), kGaugeStudies.end())));
  gauge->add_option("--case", options.the_case, "Repeat one case, like static-bad-17, and write its picture");
  gauge->add_option("--seed", g.seed, "Of everything that is drawn")->capture_default_str();
  gauge->add_option("--results-dir", options.results_dir, "Folder for the results")->capture_default_str();
  gauge->add_option("--jobs,-j", g.jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  gauge->add_flag("--quiet,-q", options.quiet, "Only the claims that do not hold");
  return gauge;
}

CLI::App* addRecordFrames(CLI::App& app, RecordFramesOptions& options) {
  CLI::App* record = app.add_subcommand(
      "record-frames",
      "Record the real spot camera that a scenario names (cameras.spot), for replay --frames. Buffers are "
      "written as the\n"
      "driver gives them, faulty ones included. Exit code 3: the camera ended before all came.");
  record->add_option("SCENARIO", options.scenario, "Whose camera, format and settings")->required();
  record->add_option("--out", options.out, "Folder for the recording, empty or not there yet")->required();
  record->add_option("--frames", options.frames,
                     "So many; otherwise until the time is over or none comes any more");
  record->add_option("--seconds", options.time_limit_s, "At most so long, after --wait")
      ->check(CLI::Range(0.001, 36000.0))
      ->capture_default_str();
  record->add_option("--wait", options.wait_s, "For the first frame, in seconds")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
  record->add_flag("--quiet,-q", options.quiet, "Only the result");
  return record;
}

CLI::App* addCapture(CLI::App& app, CaptureCommandOptions& options) {
  CLI::App* capture = app.add_subcommand(
      "capture",
      "Record a controller's real pins to pins.vcd, without model and verdict; `replay` judges it later.\n"
      "Exit code 0; 3: what was recorded cannot be trusted.");
  capture->add_option("SCENARIO", options.scenario, "Scenario on real pins (firmware.source: gpio, analyser)")
      ->required();
  capture->add_option("-o,--out", options.out, "Folder for the recording; else results/NAME-capture");
  capture->add_flag("--sr", options.session, "pins.sr too, for PulseView and sigrok-cli; of an analyser");
  capture->add_option("--time-limit", options.time_limit_s, "Real seconds, instead of the scenario's")
      ->check(CLI::PositiveNumber);
  capture->add_flag("--quiet,-q", options.quiet, "Only what is wrong");
  return capture;
}

CLI::App* addDoctor(CLI::App& app, DoctorOptions& options) {
  CLI::App* doctor = app.add_subcommand(
      "doctor",
      "What hardware this computer has for real pins (chips, lines, logic analysers, clock, real-time "
      "limits), what is wrong "
      "with "
      "it\nand what to do. Exit code 0; with a scenario 1 if something that it needs is missing.\n"
      "--bench measures instead: how many edges a second are read without loss, and what stamps are worth; "
      "exit "
      "code 1 if that\nfails.");
  doctor->add_option("SCENARIO", options.scenario, "Is there what this scenario needs?");
  doctor->add_flag("--json", options.json, "As JSON");
  addBenchOptions(*doctor, options.bench);
  return doctor;
}

int dispatch(int argc, char** argv) {
  CommonOptions options;
  options.bin_dir = fs::read_symlink("/proc/self/exe").parent_path();
  options.command_line = commandLine(argc, argv);
  options.jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U));

  CLI::App app{
      "Kerfbench: hardware-in-the-loop test bench and digital twin for laser die-cutters.\n"
      "Takes a firmware release, lets it cut a dieline on a modelled machine, looks at the cut with a "
      "camera\n"
      "and says whether the release is good.",
      "kerfbench"};
  app.set_version_flag("--version", KERFBENCH_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 PASS, 1 FAIL, 3 INVALID (the evidence cannot be trusted), 4 NOT PROVEN (inside the "
      "guard band),\n"
      "2 the bench itself broke, 64 wrong command line, 65 bad input file.\n"
      "Several scenarios: INVALID outweighs FAIL, FAIL outweighs NOT PROVEN.");

  std::vector<fs::path> scenarios;
  CLI::App* run = app.add_subcommand(
      "run",
      "Run scenarios: firmware, machine, camera, verdict, report.\nA scenario on real pins (source: gpio, "
      "analyser) runs in real time; docs/HARDWARE.md has its keys.");
  run->add_option("SCENARIO", scenarios, "Scenario files (fixtures/scenarios/*.yaml)")->required();
  addCommonOptions(*run, options);

  fs::path recording;
  fs::path replay_scenario;
  CLI::App* replay = app.add_subcommand("replay", "Judge recorded pins (pins.vcd, .sr) as if they were live");
  replay
      ->add_option("RECORDING", recording,
                   "VCD file with 1-bit wires named like galvo_x_pul,\nor a session file of sigrok (.sr), "
                   "channels named so or as the scenario's lines")
      ->required();
  replay->add_option("--scenario", replay_scenario, "The scenario that was recorded")->required();
  fs::path replay_frames;
  replay->add_option("--frames", replay_frames,
                     "Recording of the real spot camera that the scenario names;\notherwise the folder spot "
                     "beside the pins");
  addCommonOptions(*replay, options);

  RecordFramesOptions record_options;
  record_options.bin_dir = options.bin_dir;
  const CLI::App* record_frames = addRecordFrames(app, record_options);
  CaptureCommandOptions capture_options;
  capture_options.bin_dir = options.bin_dir;
  const CLI::App* capture = addCapture(app, capture_options);

  std::vector<fs::path> lint_files;
  CLI::App* lint = app.add_subcommand("lint", "Check scenarios, machines (.yaml) and dielines (.dxf, .svg)");
  lint->add_option("FILE", lint_files, "Files to check")->required();
  lint->add_flag("--quiet,-q", options.quiet, "Only what is wrong");

  DoctorOptions doctor_options;
  doctor_options.bin_dir = options.bin_dir;
  const CLI::App* doctor = addDoctor(app, doctor_options);

  ShowOptions show_options;
  show_options.bin_dir = options.bin_dir;
  const CLI::App* show = addShow(app, show_options);

  CalibrateOptions calibrate_options;
  calibrate_options.jobs = options.jobs;
  HeadCalibrateOptions head_options;
  head_options.jobs = options.jobs;
  head_options.bin_dir = options.bin_dir;
  head_options.command_line = options.command_line;
  const CalibrateCommands calibrate = addCalibrate(app, calibrate_options, head_options);
  const HeadToolsCli head_tools(*calibrate.all, {options.bin_dir, options.command_line, options.jobs});

  GaugeCommandOptions gauge_options;
  gauge_options.gauge.jobs = options.jobs;
  gauge_options.command_line = options.command_line;
  const CLI::App* gauge = addGauge(app, gauge_options);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e);  // Prints help, version or the fault.
    return code == 0 ? 0 : kExitUsage;
  }
  if (run->parsed()) return runCommand(scenarios, options);
  if (replay->parsed()) return replayCommand(recording, replay_scenario, replay_frames, options);
  if (record_frames->parsed()) return recordFramesCommand(record_options);
  if (capture->parsed()) return captureCommand(capture_options);
  if (doctor->parsed()) return doctorCommand(doctor_options);
  if (show->parsed()) return showCommand(show_options);
  if (calibrate.camera->parsed()) return calibrateCameraCommand(calibrate_options);
  if (calibrate.target->parsed()) return calibrateTargetCommand(calibrate_options);
  if (calibrate.head->parsed()) return calibrateHeadCommand(head_options);
  if (const auto code = head_tools.run()) return *code;
  if (gauge->parsed()) return gaugeCommand(gauge_options);
  return lintCommand(lint_files, options);
}

}  // namespace

int main(int argc, char** argv) {
  keepFreedMemory();
  try {
    return dispatch(argc, argv);
  } catch (const std::exception& e) {
    std::fputs(fmt::format("kerfbench: the bench itself broke: {}\n", e.what()).c_str(), stderr);
    return kExitBroken;
  }
}
