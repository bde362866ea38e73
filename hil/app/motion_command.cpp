// SPDX-License-Identifier: Apache-2.0
#include "hil/app/motion_command.h"

#include <limits>
#include <memory>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/input_error.h"
#include "hil/cli/run_guarded.h"
#include "hil/diagnose/head_motion.h"
#include "hil/evidence/pin_evidence.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/belt_place.h"
#include "hil/judge/pin_wiring.h"
#include "hil/live/recording_file.h"
#include "hil/scenario/case.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

/// What a recording tells of the motion; `test_case`, `pins` and `recording` must outlive it.
diagnose::MotionSource motionOf(const scenario::Case& test_case, const evidence::PinEvidence& pins,
                                const source::PinRecording& recording) {
  const std::shared_ptr<const judge::SharedSteps> steps = judge::stepsOf(test_case, recording);
  if (!steps) throw base::InputError("the recording lacks a wire of an axis that moves the beam");
  diagnose::MotionSource motion;
  motion.place_W_mm = [steps, place = judge::placeOfSteps(test_case)](double time_s) -> Eigen::Vector2d {
    const auto [x, y] = steps->at(time_s);
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    return place(Eigen::Vector2d(x, y)).value_or(Eigen::Vector2d::Constant(kNowhere));
  };
  motion.sheet_x_mm = [&pins, start_x_mm = scenario::webOf(test_case).start_x_mm](double time_s) {
    return start_x_mm + judge::beltAt_mm(pins.belt, time_s);
  };
  for (const inspect::GateInterval& gate : pins.gates) motion.gates_s.emplace_back(gate.on_s, gate.off_s);
  motion.end_s = recording.rate.seconds(recording.end);
  return motion;
}

/// A stamp at the end of all times would ask for more rows than a disk holds.
void refuseEndless(const MotionOptions& options, double end_s) {
  constexpr double kMostRows = 2e7;
  if (end_s <= kMostRows * options.every_s) return;
  throw base::InputError(
      fmt::format("{}: lasts {:.6g} s, which makes more than {:.0f} rows of {:g} s; see --every",
                  options.recording.string(), end_s, kMostRows, options.every_s));
}

int writeMotion(const MotionOptions& options) {
  base::Console console(options.quiet);
  const scenario::Case test_case =
      scenario::readCase(options.scenario, {options.bin_dir.parent_path() / "firmware", fs::path()});
  const source::PinRecording recording =
      live::readRecording(options.recording, test_case, base::progressOn(console));
  refuseEndless(options, recording.rate.seconds(recording.end));
  const evidence::PinEvidence pins = evidence::pinEvidence(recording, judge::pinWiring(test_case));
  const diagnose::HeadMotion motion =
      diagnose::headMotion(motionOf(test_case, pins, recording), options.every_s);
  fs::create_directories(options.out);
  base::writeFileAtomically(options.out / "motion.csv", diagnose::motionTable(motion));
  base::writeFileAtomically(options.out / "motion-way.svg", diagnose::wayPicture(motion));
  base::writeFileAtomically(options.out / "motion-sheet.svg", diagnose::sheetPicture(motion));
  base::writeFileAtomically(options.out / "motion-length.svg", diagnose::lengthPicture(motion));
  console.say(diagnose::cutTable(motion));
  console.say(fmt::format("motion.csv and pictures: {}", options.out.string()));
  return 0;
}

}  // namespace

int motionCommand(const MotionOptions& options) {
  return cli::runGuarded(options.scenario, [&] { return writeMotion(options); });
}

}  // namespace kerfbench::app
