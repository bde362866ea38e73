// SPDX-License-Identifier: Apache-2.0
// Frames that must not be judged by are reported as such, and good ones are not.
#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/hil/vision/spot_twin.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

PrintLayout fourMarks() {
  PrintLayout print;
  print.units = 1;
  print.pitch_mm = 100.0;
  for (const Vector2d& p : {Vector2d{-9.0, -8.0}, {9.0, -7.5}, {-9.5, 8.0}, {9.0, 8.5}})
    print.marks.push_back({p, 3.0});
  return print;
}

struct Filmed {
  twin::CameraDescription camera = test::spotCamera();
  PrintLayout seen = fourMarks();      ///< Printed marks.
  PrintLayout believed = fourMarks();  ///< Marks of the layout.
  double spot_gray{110.0};
  double radius_mm{test::kSpotRadiusMm};
  Vector2d spot_mm{0.0, 1.0};       ///< Place of the spot in the first frame.
  Vector2d spot_step_mm{0.1, 0.0};  ///< Step of the spot from frame to frame.
  std::function<void(Frame&)> spoil = [](Frame&) {};

  [[nodiscard]] SpotTrack track() const {
    const twin::SpotCamera spot_camera(camera, seen, test::kGlowGrayPerW, 3);
    std::vector<Frame> frames;
    for (std::uint64_t i = 0; i < 24; ++i) {
      twin::Exposure exposure =
          test::exposureOf(i, spot_mm + static_cast<double>(i) * spot_step_mm, {0.1, 0.0}, spot_gray);
      for (twin::ExposureSample& sample : exposure.samples) {
        sample.radius_mm = radius_mm;
        sample.p_WS_mm.x() = 0.02 * static_cast<double>(i);
      }
      frames.push_back(spot_camera.render(exposure));
      spoil(frames.back());
    }
    return test::trackOf(camera, believed, std::move(frames), 20.0);
  }
};

bool tells(const SpotTrack& track, const std::string& word) {
  return std::any_of(track.problems.begin(), track.problems.end(),
                     [&](const std::string& problem) { return problem.find(word) != std::string::npos; });
}

TEST(SpotRefusal, GoodFramesAreNotRefused) {
  for (const int bits : {8, 12}) {
    Filmed run;
    run.camera.bits = bits;
    const SpotTrack track = run.track();
    EXPECT_TRUE(track.problems.empty()) << track.problems.front();
    for (const FrameMeasurement& frame : track.frames) {
      EXPECT_FALSE(frame.faults.any());
      ASSERT_EQ(frame.sheet.size(), 1U);
      EXPECT_EQ(frame.sheet[0].expected, 4);
      EXPECT_EQ(frame.sheet[0].marks, 4);
      EXPECT_EQ(frame.sheet[0].moved, 0);
    }
  }
}

TEST(SpotRefusal, AHardBoardAloneIsNoReason) {
  Filmed run;
  run.camera.texture = {.grain_gray = 3.0, .glow_share = 0.1};
  run.camera.light = {.vignette = 0.3, .gradient_x = 0.3};
  run.spot_gray = 900.0;
  const SpotTrack track = run.track();
  EXPECT_TRUE(track.problems.empty()) << track.problems.front();
}

// The spot moves with a mark: 7, 2 and 0 pixels from its rim. Print that it touches hides it from the first
// search; the mark may still not be measured in that light, and is not missing either.
TEST(SpotRefusal, AMarkInTheLightOfTheSpotIsNeitherMeasuredNorMissing) {
  for (const double beside_mm : {0.7, 0.2, 0.0}) {
    SCOPED_TRACE(beside_mm);
    Filmed run;
    run.spot_gray = 200.0;
    run.spot_mm = {9.0 - 1.5 - beside_mm, 8.5};
    run.spot_step_mm = {0.02, 0.0};
    const SpotTrack track = run.track();
    EXPECT_TRUE(track.problems.empty()) << track.problems.front();
    double off_mm = 0.0;
    for (const FrameMeasurement& frame : track.frames) {
      EXPECT_TRUE(frame.spot_W_mm);
      ASSERT_EQ(frame.sheet.size(), 1U);
      EXPECT_EQ(frame.sheet[0].expected, 3);
      EXPECT_EQ(frame.sheet[0].marks, 3);
      off_mm += (frame.sheet[0].p_WS_mm.x() - 0.02 * static_cast<double>(frame.sequence)) / 24.0;
    }
    EXPECT_NEAR(off_mm, 0.0, 4.0 * std::sqrt(track.frames[9].sheet[0].covariance(0, 0) / 24.0));
  }
}

TEST(SpotRefusal, DarkFrames) {
  Filmed run;
  run.camera.board_gray = 3.0;
  EXPECT_TRUE(tells(run.track(), "dark"));
}

TEST(SpotRefusal, SaturatedFrames) {
  Filmed bright;
  bright.camera.board_gray = 255.0;
  EXPECT_TRUE(tells(bright.track(), "saturated"));
  Filmed glare;
  glare.camera.plume = {.share = 0.5, .offset_mm = {0.0, 0.0}, .sigma_mm = 2.0};
  glare.spot_gray = 900.0;
  EXPECT_TRUE(tells(glare.track(), "saturated"));
}

TEST(SpotRefusal, BlurredFrames) {
  Filmed run;
  run.camera.psf_sigma_px = 4.5;
  run.spot_gray = 3000.0;
  EXPECT_TRUE(tells(run.track(), "blurred"));
}

TEST(SpotRefusal, FramesThatNoSensorTook) {
  Filmed run;
  run.spoil = [](Frame& frame) { frame.image = GrayImage(frame.image.width, frame.image.height, 110); };
  EXPECT_TRUE(tells(run.track(), "noise"));
}

TEST(SpotRefusal, OneBadFrameIsEnough) {
  Filmed run;
  run.spoil = [](Frame& frame) {
    if (frame.sequence == 13) frame.image = GrayImage(frame.image.width, frame.image.height, 0);
  };
  const SpotTrack track = run.track();
  ASSERT_TRUE(tells(track, "1 frames of the spot camera are dark, the first is number 13"));
}

TEST(SpotRefusal, FramesOfAnotherSize) {
  Filmed run;
  run.spoil = [](Frame& frame) {
    if (frame.sequence == 5) frame.image = GrayImage(frame.image.width - 1, frame.image.height, 110);
  };
  EXPECT_THROW((void)run.track(), std::invalid_argument);
}

TEST(SpotRefusal, ABoardOutsideTheField) {
  Filmed run;
  for (RegistrationMark& mark : run.seen.marks) mark.p_SM_mm.x() += 500.0;
  const SpotTrack track = run.track();
  // The run is then INVALID: unplaced.
  for (const FrameMeasurement& frame : track.frames) EXPECT_TRUE(frame.sheet.empty());
}

TEST(SpotRefusal, MarksThatAreMissing) {
  Filmed run;
  run.seen.marks.pop_back();
  EXPECT_TRUE(tells(run.track(), "missing"));
}

TEST(SpotRefusal, MarksThatMoved) {
  Filmed run;
  run.seen.marks[1].p_SM_mm += Vector2d(0.15, 0.1);
  EXPECT_TRUE(tells(run.track(), "do not lie"));
}

}  // namespace
}  // namespace kerfbench::vision
