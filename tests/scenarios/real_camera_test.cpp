// SPDX-License-Identifier: Apache-2.0
// A spot camera on V4L2: a scripted device delivers the pictures of the twin's camera in a run.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <future>
#include <string>

#include "hil/judge/real_spot.h"
#include "hil/live/salvage_evidence.h"
#include "hil/live/spot_recorder.h"
#include "hil/run/release.h"
#include "hil/scenario/camera_files.h"
#include "hil/source/vcd.h"
#include "tests/scenarios/filmed_cut.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using camera::FakeVideo;
using inspect::Verdict;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Cut that is made once for all tests.
const FilmedCut& goodCut() {
  static const FilmedCut cut(fixture("scenarios/native/label-camera.yaml"));
  return cut;
}

std::string problemsOf(const report::RunReport& report) {
  std::string text;
  for (const std::string& problem : report.result.problems) text += problem + "\n";
  return text;
}

/// Report of the good run, with `spoil` applied to the camera.
report::RunReport filmedWith(const std::function<void(FakeVideo&, std::size_t)>& spoil) {
  const ScratchFolder scratch;
  const auto camera = goodCut().camera();
  spoil(*camera, goodCut().frameAt(*camera, goodCut().middleOfACut_s()));
  (void)goodCut().record(*camera, scratch.path() / "spot");
  return goodCut().judged(scratch.path() / "spot");
}

TEST(RealCamera, GivesAGoodReleaseAPassAndAReplayOfItsFramesTheSameDigest) {
  const ScratchFolder scratch;
  const auto folder = scratch.path() / "spot";
  const auto camera = goodCut().camera();
  EXPECT_THAT(goodCut().record(*camera, folder), HasSubstr("no frame within"));
  report::RunReport live = goodCut().judged(folder, 1);
  EXPECT_EQ(live.result.verdict, Verdict::kPass) << problemsOf(live);
  EXPECT_EQ(report::digestOf(live), report::digestOf(goodCut().judged(folder, 2)));

  // The program gives the same result for pins and frames, up to the controller's words.
  const auto pins = scratch.path() / "pins.vcd";
  source::PinRecording recording = goodCut().run().recording;
  recording.uart.clear();
  live.evidence.push_back({"pins", source::writeVcd(pins, recording, goodCut().theCase().machine.signals)});
  const auto replay =
      kerfbench(fmt::format("replay '{}' --scenario '{}' -q --no-pictures --results-dir '{}'", pins.string(),
                            fixture("scenarios/native/label-camera.yaml").string(), scratch.path().string()));
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  const auto verdict = verdictOf(scratch.path() / "label-camera-replay");
  EXPECT_EQ(verdict.at("digest"), report::digestOf(live));
  // The model that ran along with the same pins is the same machine.
  ASSERT_FALSE(verdict.at("model").at("partings").empty());
  for (const auto& parting : verdict.at("model").at("partings")) {
    EXPECT_LT(std::abs(parting.at("mean_x_mm").get<double>()), 0.05);
    EXPECT_LT(std::abs(parting.at("mean_y_mm").get<double>()), 0.05);
  }
  EXPECT_THAT(verdict.at("versions").dump(),
              AllOf(HasSubstr("Fake camera"), HasSubstr("of the model: no real sheet")));
}

TEST(RealCamera, GivesABadReleaseAFail) {
  const ScratchFolder scratch;
  const auto scenario = scratch.path() / "bad.yaml";
  std::ofstream(scenario) << "extends: " << fixture("scenarios/native/label-camera.yaml").string()
                          << "\nname: bad\nplanner: {faults: {ignore_belt: true}}\n";
  const FilmedCut bad(scenario);
  const auto camera = bad.camera();
  (void)bad.record(*camera, scratch.path() / "spot");
  const report::RunReport report = bad.judged(scratch.path() / "spot");
  EXPECT_EQ(report.result.verdict, Verdict::kFail) << problemsOf(report);
  const auto stillness = std::ranges::find(report.result.checks, "stillness_x", &inspect::Check::name);
  ASSERT_NE(stillness, report.result.checks.end());
  EXPECT_EQ(stillness->verdict, Verdict::kFail);
}

// Mode 2: a machine whose Y mirror rests 200 urad off, and a model without that error.
TEST(RealCamera, ShowsWhereTheMachineAndItsModelPart) {
  const ScratchFolder scratch;
  std::ofstream(scratch.path() / "machine.yaml")
      << "extends: " << fixture("machines/two-mirror-camera.yaml").string()
      << "\noptics: {mirror_y: {zero_urad: 200}}\n";
  std::ofstream(scratch.path() / "askew.yaml")
      << "extends: " << fixture("scenarios/native/label-camera.yaml").string()
      << "\nname: askew\nmachine: machine.yaml\n";
  const FilmedCut askew(scratch.path() / "askew.yaml");
  const auto camera = askew.camera();
  (void)askew.record(*camera, scratch.path() / "spot");
  source::PinRecording recording = askew.run().recording;
  recording.uart.clear();
  source::writeVcd(scratch.path() / "pins.vcd", recording, askew.theCase().machine.signals);
  const auto replay =
      kerfbench(fmt::format("replay '{}' --scenario '{}' -q --no-pictures --results-dir '{}'",
                            (scratch.path() / "pins.vcd").string(),
                            fixture("scenarios/native/label-camera.yaml").string(), scratch.path().string()));
  const auto results = scratch.path() / "label-camera-replay" / "latest";
  const auto verdict = verdictOf(results);
  ASSERT_FALSE(verdict.is_null()) << replay.output;
  double frames = 0.0;
  double sum_mm = 0.0;
  for (const auto& parting : verdict.at("model").at("partings")) {
    frames += parting.at("frames").get<double>();
    sum_mm += parting.at("frames").get<double>() * parting.at("mean_y_mm").get<double>();
  }
  ASSERT_GT(frames, 150.0) << replay.output;
  // The spot moves by twice the angle times the throw of 500 mm.
  EXPECT_NEAR(std::abs(sum_mm / frames), 0.2, 0.02);
  EXPECT_THAT(textOf(results / "report.html"), HasSubstr("Where machine and model part"));
}

// The light is soft: power follows the speed, so the gate alone gives no more than some milliseconds.
TEST(RealCamera, IsRelatedToThePinsByTheLaserWithinTheBoundThatItTells) {
  const ScratchFolder scratch;
  const std::vector<double> begins_s = goodCut().begins_s();
  const auto calibration = scenario::readCalibrations(goodCut().theCase()).spot;
  inspect::Evidence laser;
  laser.gates = goodCut().gates();
  for (const double drift : {0.0, 100e-6}) {
    const auto folder = scratch.path() / fmt::format("drift-{}", drift);
    const auto camera = goodCut().camera(drift);
    (void)goodCut().record(*camera, folder);
    const judge::RealSpot spot = judge::lookAtRealSpot(goodCut().theCase(), folder, calibration.value(),
                                                       goodCut().run().recording, laser, 2);
    ASSERT_GT(spot.track.frames.size(), 300U);
    EXPECT_LT(spot.clock_bound_s, 1e-3);
    double worst_s = 0.0;
    for (const vision::FrameMeasurement& frame : spot.track.frames) {
      const double begin_s = frame.mid_s - 100e-6;
      const auto after = std::ranges::lower_bound(begins_s, begin_s - 1e-3);
      ASSERT_NE(after, begins_s.end());
      worst_s = std::max(worst_s, std::abs(begin_s - *after));
    }
    EXPECT_LT(worst_s, spot.clock_bound_s);
    RecordProperty(fmt::format("worst_us_{}", drift),
                   fmt::format("{:.1f} of {:.1f}", 1e6 * worst_s, 1e6 * spot.clock_bound_s));
  }
}

TEST(RealCamera, SeesOnlyDarknessWhereNothingIsCut) {
  const report::RunReport report = filmedWith([](FakeVideo& camera, std::size_t) {
    const std::vector<std::uint8_t> dark = camera.frames.front().bytes;
    std::uint8_t noise = 0;
    for (camera::FakeFrame& frame : camera.frames) {
      frame.bytes = dark;
      frame.bytes[0] = noise++;
    }
  });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("clock cannot be related to that of the pins: none of"));
}

TEST(RealCamera, ThatLosesAFrameDuringACutIsInvalid) {
  const report::RunReport report = filmedWith([](FakeVideo& camera, std::size_t at) {
    camera.frames.erase(camera.frames.begin() + static_cast<std::ptrdiff_t>(at));
  });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report),
              AllOf(HasSubstr("during a cut: 1 frames were lost"), HasSubstr("lost 1 frames around cuts")));
}

TEST(RealCamera, ThatLosesAFrameBeforeTheFirstCutIsAsGood) {
  const report::RunReport report =
      filmedWith([](FakeVideo& camera, std::size_t) { camera.frames.erase(camera.frames.begin() + 3); });
  EXPECT_EQ(report.result.verdict, Verdict::kPass) << problemsOf(report);
}

TEST(RealCamera, ThatRepeatsAPictureDuringACutIsInvalid) {
  const report::RunReport report = filmedWith(
      [](FakeVideo& camera, std::size_t at) { camera.frames[at].bytes = camera.frames[at - 1].bytes; });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("its picture is the one before, to the byte"));
}

TEST(RealCamera, ThatGivesANumberTwiceDuringACutIsInvalid) {
  const report::RunReport report = filmedWith([](FakeVideo& camera, std::size_t at) {
    for (std::size_t i = at; i < camera.frames.size(); ++i) --camera.frames[i].sequence;
  });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("its number is that of the frame before"));
}

TEST(RealCamera, ThatFlagsAFrameDuringACutIsInvalid) {
  const report::RunReport report =
      filmedWith([](FakeVideo& camera, std::size_t at) { camera.frames[at].flags |= V4L2_BUF_FLAG_ERROR; });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("the driver marks it as damaged"));
}

TEST(RealCamera, ThatCutsAFrameOffDuringACutIsInvalid) {
  const report::RunReport report =
      filmedWith([](FakeVideo& camera, std::size_t at) { camera.frames[at].bytesused = 1000; });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("too few or too many bytes"));
}

TEST(RealCamera, ThatStopsDuringACutIsInvalid) {
  const report::RunReport report = filmedWith([](FakeVideo& camera, std::size_t at) {
    camera.frames.erase(camera.frames.begin() + static_cast<std::ptrdiff_t>(at), camera.frames.end());
  });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("no frame within 1000 ms"));
}

TEST(RealCamera, ThatVanishesDuringACutIsInvalid) {
  const report::RunReport report = filmedWith([](FakeVideo& camera, std::size_t at) {
    camera.frames[at].before = [&camera] { camera.is_gone = true; };
  });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("the camera has vanished"));
}

TEST(RealCamera, ThatChangesItsSizeDuringACutIsInvalid) {
  const report::RunReport report = filmedWith([](FakeVideo& camera, std::size_t at) {
    camera.frames[at].before = [&camera] { camera.format.width = 640; };
  });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("GREY 800 x 400 became GREY 640 x 400"));
}

TEST(RealCamera, WhoseStampsRunWildIsInvalid) {
  const report::RunReport report =
      filmedWith([](FakeVideo& camera, std::size_t at) { camera.frames[at].stamp_ns -= 50'000'000; });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("its stamp is not later than that of the frame before"));
}

TEST(RealCamera, ThatSeesBarelyAnythingOfTheJobIsInvalid) {
  const report::RunReport report =
      filmedWith([](FakeVideo& camera, std::size_t) { camera.frames.resize(1); });
  EXPECT_EQ(report.result.verdict, Verdict::kInvalid);
  EXPECT_THAT(problemsOf(report), HasSubstr("the spot camera gave no frame: no frame within"));
}

TEST(RealCamera, IsRecordedInTheBackgroundUntilItIsAskedToStop) {
  const ScratchFolder scratch;
  const auto camera = goodCut().camera();
  std::promise<void> reached;
  std::future<void> is_reached = reached.get_future();
  camera->frames[20].before = [&reached] { reached.set_value(); };
  live::SpotRecorder recorder(goodCut().theCase(), *camera, scratch.path() / "spot");
  is_reached.get();
  (void)recorder.finish();
  EXPECT_GE(recorder.frames(), 18U);
  const camera::FrameRecording recording(scratch.path() / "spot");
  EXPECT_EQ(recording.frames(), recorder.frames());
  EXPECT_EQ(recording.camera().card, "Fake camera");
  EXPECT_EQ(recording.setup().exposure_s, 200e-6);
}

// The real run cannot be concluded.
TEST(RealCamera, FramesAreKeptBesideThePinsIfTheyAreWhole) {
  const ScratchFolder scratch;
  const auto camera = goodCut().camera();
  (void)goodCut().record(*camera, scratch.path() / "whole");
  fs::copy(scratch.path() / "whole", scratch.path() / "torn");
  fs::remove(scratch.path() / "torn" / "camera.yaml");
  base::Console console(true);
  const auto keep = [&](const fs::path& frames) {
    testing::internal::CaptureStdout();
    live::salvageEvidence(goodCut().theCase(), goodCut().run().recording, frames, scratch.path(), console);
    return testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(keep(scratch.path() / "whole"), Not(HasSubstr("lost")));
  const camera::FrameRecording kept(scratch.path() / "label-camera-capture" / "spot");
  EXPECT_GT(kept.frames(), 0U);
  EXPECT_FALSE(fs::exists(scratch.path() / "whole"));
  EXPECT_THAT(keep(scratch.path() / "torn"), HasSubstr("the frames are not whole, and are lost"));
  EXPECT_TRUE(fs::exists(scratch.path() / "label-camera-capture-2" / "pins.vcd"));
  EXPECT_FALSE(fs::exists(scratch.path() / "label-camera-capture-2" / "spot"));
  std::ofstream(scratch.path() / "no-folder") << "a file";
  testing::internal::CaptureStdout();
  live::salvageEvidence(goodCut().theCase(), goodCut().run().recording, {}, scratch.path() / "no-folder",
                        console);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("could not be kept"));
}

TEST(RealCamera, IsRefusedWithEveryReasonWhereItIsNotAsAskedFor) {
  const ScratchFolder scratch;
  const auto camera = goodCut().camera();
  camera->controls.clear();
  camera->can_set_interval = 0;
  camera->fourccs = {V4L2_PIX_FMT_YUYV};
  camera->is_stubborn_format = true;
  try {
    (void)live::openSpotCamera(goodCut().theCase(), *camera);
    FAIL();
  } catch (const base::InputError& fault) {
    EXPECT_THAT(fault.what(),
                AllOf(HasSubstr("label-camera.yaml:14: cameras.spot.device: size"),
                      HasSubstr("label-camera.yaml:16: cameras.spot.exposure_us: the camera has no such"),
                      HasSubstr("label-camera.yaml:17: cameras.spot.frames_per_s: the driver cannot")));
  }
}

TEST(RealCamera, IsRefusedWhereItMakesAnotherSettingOfIt) {
  const auto camera = goodCut().camera();
  camera->value_step = 3;
  camera->controls.erase(camera->controls.begin());  // The camera has no automatic exposure.
  try {
    (void)live::openSpotCamera(goodCut().theCase(), *camera);
    FAIL();
  } catch (const base::InputError& fault) {
    EXPECT_THAT(fault.what(),
                HasSubstr("label-camera.yaml:16: cameras.spot.exposure_us: exposure_s = 0.0002 was asked "
                          "for, and the camera made 0 of it"));
  }
}

TEST(RealCamera, WithoutPermissionSaysWhatToDo) {
  const auto camera = goodCut().camera();
  camera->open_error = EACCES;
  try {
    (void)live::openSpotCamera(goodCut().theCase(), *camera);
    FAIL();
  } catch (const base::InputError& fault) {
    EXPECT_THAT(fault.what(), AllOf(HasSubstr("label-camera.yaml:14: cameras.spot.device: /dev/video7"),
                                    HasSubstr("group \"video\"")));
  }
}

TEST(RealCamera, SeesNothingOfEmulatedPins) {
  const ScratchFolder scratch;
  const auto run =
      kerfbench(fmt::format("run '{}' -q --results-dir '{}'",
                            fixture("scenarios/native/label-camera.yaml").string(), scratch.path().string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output,
              AllOf(HasSubstr("cameras.spot.device: the pins are emulated"), HasSubstr("--frames")));
}

TEST(RealCamera, WithoutARecordingOfItsFramesIsNotReplayed) {
  const ScratchFolder scratch;
  const auto pins = scratch.path() / "pins.vcd";
  source::writeVcd(pins, goodCut().run().recording, goodCut().theCase().machine.signals);
  const std::string scenario = fixture("scenarios/native/label-camera.yaml").string();
  const auto run = kerfbench(fmt::format("replay '{}' --scenario '{}' -q --results-dir '{}'", pins.string(),
                                         scenario, scratch.path().string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output,
              HasSubstr("there is no recording of its frames in " + (scratch.path() / "spot").string()));
  const auto other =
      kerfbench(fmt::format("replay '{}' --scenario '{}' --frames '{}' -q --results-dir '{}'", pins.string(),
                            fixture("scenarios/native/label-on-belt.yaml").string(), scratch.path().string(),
                            scratch.path().string()));
  EXPECT_EQ(other.exit_code, 65);
  EXPECT_THAT(other.output, HasSubstr("has no real spot camera"));
}

}  // namespace
}  // namespace kerfbench::test
