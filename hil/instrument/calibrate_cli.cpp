// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hil/cli/program.h"
#include "hil/instrument/calibrate_command.h"
#include "hil/instrument/calibrate_head_command.h"
#include "hil/instrument/cli.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::instrument {
namespace {

void addWhichCamera(CLI::App& command, CalibrateOptions& options, bool required) {
  CLI::Option* machine = command.add_option("--machine", options.machine, "Machine file")->required(required);
  command
      .add_option("--camera", options.camera,
                  "spot (over the work plane) or kerf (over the inspection table)")
      ->check(CLI::IsMember({"spot", "kerf"}))
      ->required(required)
      ->needs(machine);
}

void addModelOptions(CLI::App* head, HeadCalibrateOptions& options) {
  head->add_option("--seed", options.seed, "Of what the imperfections draw, of all noise and of the places")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9'000'000'000'000'000}))
      ->capture_default_str();
  head->add_option("--imperfections", options.imperfections,
                   "How far the machine is from its description: ideal, static, dynamic")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kPresetNames.begin(), scenario::kPresetNames.end())))
      ->capture_default_str();
  head->add_option("--twin", options.twin, "How the equations of motion are solved: reference or fast")
      ->check(CLI::IsMember(
          std::vector<std::string>(scenario::kFidelityNames.begin(), scenario::kFidelityNames.end())))
      ->capture_default_str();
  head->add_option("--date", options.date,
                   "Day of the jobs, like 2026-11-21; otherwise that of the kerf camera's calibration");
  head->add_option("--out", options.out, "The controller's table; otherwise correction.csv in the results");
  head->add_flag("--keep-pictures", options.keep_pictures, "Keep the pictures of each sheet beside its job");
}

void addSourceOfPictures(CLI::App* head, HeadCalibrateOptions& options) {
  CLI::Option* by_hand =
      head->add_flag("--by-hand", options.by_hand,
                     "Sheets are cut on a machine and photographed by people: what they need is written into "
                     "the results and "
                     "said,\nexit code 75; run again when the pictures of a sheet are there");
  head->add_option("--image", options.image,
                   "By hand: release of the controller that cuts, such as controller-avr.hex; otherwise\n"
                   "controller-native-galvo")
      ->needs(by_hand);
  head->add_option("--scanner", options.scanner,
                   "By hand: calibration of the scanner (calibrate scanner) for sheets that are scanned")
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
}

void addCalibrateHead(CLI::App& calibrate, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<HeadCalibrateOptions>();
  HeadCalibrateOptions& options = *holder;
  options.jobs = program.jobs;
  options.bin_dir = program.bin_dir;
  options.command_line = program.command_line;
  options.results_dir = program.results / "head";
  CLI::App* head = calibrate.add_subcommand(
      "head",
      "Calibrate a scan head on the twin: marks are cut, found in the kerf camera's pictures, and the head "
      "is "
      "fitted;\n"
      "its correction table is verified at places that were never marked. docs/how-to/calibrate-a-head.md "
      "says how.\n"
      "Exit code 0: the table is good, U included; 1: it is not; 3: the marks cannot be trusted; 4: not "
      "proven;\n65: bad input; 75: by hand, waiting. In all but the first the table named by --out stays as "
      "it "
      "is. What is\nmeasured already is not done again.");
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
  head->add_option("--limit-mm", options.limit_mm,
                   "Largest error of the beam anywhere in the field, U included")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  head->add_option(
          "--unmodelled-share", options.unmodelled_share,
          "What encoders, lens and board may do that the head's parameters do not describe (1 sigma), "
          "as a share\nof the field's longer side: by their data sheets. It is in what is stated as "
          "long as fewer than 40 marks\nare measured; more of them tell it themselves")
      ->check(CLI::Range(1e-7, 0.1))
      ->capture_default_str();
  addModelOptions(head, options);
  addSourceOfPictures(head, options);
  head->add_option("--jobs,-j", options.jobs, "Threads; the result is the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  head->add_flag("--quiet,-q", options.quiet, "Only the result");
  actions.add(head, std::move(holder), calibrateHeadCommand);
}

void addCalibrateCamera(CLI::App& calibrate, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<CalibrateOptions>();
  CalibrateOptions& options = *holder;
  options.jobs = program.jobs;
  CLI::App* camera = calibrate.add_subcommand(
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
  actions.add(camera, std::move(holder), calibrateCameraCommand);
}

void addCalibrateTarget(CLI::App& calibrate, cli::CliActions& actions) {
  auto holder = std::make_shared<CalibrateOptions>();
  CalibrateOptions& options = *holder;
  CLI::App* target =
      calibrate.add_subcommand("target", "Write a target to print (SVG) and its description (YAML)");
  target->add_option("--out", options.out, "SVG file; the description goes beside it")->required();
  addWhichCamera(*target, options, false);
  target->add_option("--columns", options.columns, "Squares; otherwise as fits the camera")
      ->check(CLI::Range(4, 200));
  target->add_option("--rows", options.rows, "Squares")->check(CLI::Range(4, 200));
  target->add_option("--square-mm", options.square_mm, "Side of a square")->check(CLI::Range(0.1, 1000.0));
  target->add_flag("--quiet,-q", options.quiet, "Nothing but what is wrong");
  actions.add(target, std::move(holder), calibrateTargetCommand);
}

}  // namespace

void addCalibrate(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  CLI::App* calibrate = app.add_subcommand(cli::kCalibrate.name, cli::kCalibrate.help);
  calibrate->require_subcommand(1);
  addCalibrateCamera(*calibrate, program, actions);
  addCalibrateTarget(*calibrate, actions);
  addCalibrateHead(*calibrate, program, actions);
  addHeadTools(*calibrate, program, actions);
}

}  // namespace kerfbench::instrument
