// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "hil/app/capture_command.h"
#include "hil/app/cli.h"
#include "hil/app/doctor_command.h"
#include "hil/app/loopback_cli.h"
#include "hil/app/record_frames_command.h"
#include "hil/live/capture_on_pins.h"
#include "hil/live/real_pins.h"
#include "hil/live/record_frames.h"
#include "hil/live/spot_recorder.h"

namespace kerfbench::app {
void addRecordFrames(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<live::RecordFramesOptions>();
  live::RecordFramesOptions& options = *holder;
  options.bin_dir = program.bin_dir;
  CLI::App* record = app.add_subcommand(
      "record-frames",
      "Record the real spot camera that a scenario names (cameras.spot), for replay --frames. Buffers are "
      "written as the\n"
      "driver gives them, faulty ones included. Exit code 3: fewer came than --frames, or none.");
  record->add_option("SCENARIO", options.scenario, "Whose camera, format and settings")->required();
  record->add_option("--out", options.out, "Folder for the recording, empty or not there yet")->required();
  record->add_option("--frames", options.frames,
                     "So many; otherwise until the time is over or none comes any more");
  record->add_option("--seconds", options.time_limit_s, "At most so long, from the first frame on")
      ->check(CLI::Range(0.001, 36000.0))
      ->capture_default_str();
  record->add_option("--wait", options.wait_s, "For the first frame at most so long, in seconds")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
  record->add_flag("--quiet,-q", options.quiet, "Only the result");
  actions.add(record, std::move(holder), recordFramesCommand);
}

void addCapture(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<live::CaptureOptions>();
  live::CaptureOptions& options = *holder;
  options.bin_dir = program.bin_dir;
  CLI::App* capture = app.add_subcommand(
      "capture",
      "Record a controller's real pins to pins.vcd, without model and verdict; `replay` judges it later.\n"
      "Exit code 0; 3: what was recorded cannot be trusted; 2: pins.vcd is there and pins.sr (--sr) could "
      "not be written.");
  capture->add_option("SCENARIO", options.scenario, "Scenario on real pins (firmware.source: gpio, analyser)")
      ->required();
  capture->add_option("-o,--out", options.out, "Folder for the recording; else results/NAME-capture");
  capture->add_flag("--sr", options.session, "pins.sr too, for PulseView and sigrok-cli; of an analyser");
  capture->add_option("--time-limit", options.time_limit_s, "Real seconds, instead of the scenario's")
      ->check(CLI::PositiveNumber);
  capture->add_flag("--quiet,-q", options.quiet, "Only what is wrong");
  actions.add(capture, std::move(holder), captureCommand);
}

void addDoctor(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<DoctorOptions>();
  DoctorOptions& options = *holder;
  options.bin_dir = program.bin_dir;
  CLI::App* doctor =
      app.add_subcommand("doctor",
                         "What hardware this computer has for real pins and cameras (chips, "
                         "lines, logic analysers, cameras, clock,\n"
                         "real-time limits), what is wrong with it and what to do. Exit code "
                         "0; with a scenario 1 if something that\n"
                         "it needs is missing. --bench measures instead: how many edges a "
                         "second are read without loss, and what\n"
                         "stamps are worth; exit code 1 if that fails.\n--child tries a program that "
                         "is to run images: exit code 1 if it breaks the pin stream.");
  doctor->add_option("SCENARIO", options.scenario, "Is there what this scenario needs?");
  doctor->add_flag("--json", options.json, "As JSON");
  addLoopbackOptions(*doctor, options.bench);
  CLI::Option* const child = doctor->add_option(
      "--child", options.child.child,
      "Try this program instead: does it keep what docs/reference/pin-stream.md asks of a child?");
  CLI::Option* const image =
      doctor->add_option("--image", options.child.image, "The image that it runs")->needs(child);
  child->needs(image);
  doctor->add_option("--for", options.child.seconds, "Virtual seconds of each run")
      ->needs(child)
      ->check(CLI::Range(0.001, 60.0))
      ->capture_default_str();
  doctor->add_option("--mcu", options.child.mcu, "Processor that the child is asked for")
      ->needs(child)
      ->capture_default_str();
  doctor->add_option("--clock-hz", options.child.clock_hz, "Clock that it is asked for")
      ->needs(child)
      ->check(CLI::Range(std::uint64_t{100'000}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  doctor->add_option("--baud", options.child.baud, "Rate of its UART")
      ->needs(child)
      ->check(CLI::Range(300U, 4'000'000U))
      ->capture_default_str();
  actions.add(doctor, std::move(holder), doctorCommand);
}

}  // namespace kerfbench::app
