// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/spot_track.h"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

constexpr double kPitchMm = 0.1;
constexpr double kBoard = 110.0;
constexpr double kInk = 25.0;
constexpr double kLensPx = 0.6;
constexpr double kSpotSigmaMm = 0.0525;

PrintLayout noPrint() {
  PrintLayout print;
  print.pitch_mm = 100.0;
  return print;
}

/// Four marks at the corners of a unit, not quite a rectangle.
PrintLayout fourMarks(int units = 1, double pitch_mm = 40.0) {
  PrintLayout print;
  print.units = units;
  print.pitch_mm = pitch_mm;
  print.marks = {{{25.0, -15.0}, 3.0}, {{25.0, 15.0}, 3.0}, {{2.0, -15.0}, 3.0}, {{4.0, 15.0}, 3.0}};
  return print;
}

Eigen::Vector2d turned(const Eigen::Vector2d& p, double angle) {
  return {std::cos(angle) * p.x() - std::sin(angle) * p.y(),
          std::sin(angle) * p.x() + std::cos(angle) * p.y()};
}

struct Scene {
  CameraCalibration camera = test::tiltedCamera(640, 480, kPitchMm);
  PrintLayout print = noPrint();
  double speed_mm_s{200.0};
  double period_s{0.001};
  double exposure_s{50e-6};

  [[nodiscard]] Frame frame(const test::Canvas& canvas, std::uint64_t sequence) const {
    return {canvas.expose(7, sequence), sequence, static_cast<double>(sequence) * period_s, exposure_s};
  }
  /// Board with the marks of all units; the web's S lies at p_WS_mm, turned.
  [[nodiscard]] test::Canvas web(const Eigen::Vector2d& p_WS_mm, double angle, int left_out_unit = -1,
                                 std::size_t left_out = 0) const {
    test::Canvas canvas(camera, kBoard);
    for (int unit = 0; unit < print.units; ++unit) {
      for (std::size_t i = 0; i < print.marks.size(); ++i) {
        if (unit == left_out_unit && i == left_out) continue;
        const Eigen::Vector2d p_S = print.marks[i].p_SM_mm - Eigen::Vector2d(unit * print.pitch_mm, 0.0);
        const Eigen::Vector2d p_W = p_WS_mm + turned(p_S, angle);
        if (camera.pixelIfSeen(p_W, -40.0)) canvas.disc(p_W, print.marks[i].diameter_mm, kInk);
      }
    }
    canvas.blur(kLensPx);
    return canvas;
  }
  [[nodiscard]] SpotTrack track(std::vector<Frame> frames, int threads = 1) const {
    test::ReadyFrames source(std::move(frames));
    return trackSpot(source, camera, print, {threads, speed_mm_s});
  }
};

struct SpotErrors {
  std::vector<double> x, y, told;
  int dark{};
};

/// Spots at random places, streaked by `streak_mm`.
SpotErrors measureSpots(const Eigen::Vector2d& streak_mm, double height_gray, int count) {
  const Scene scene;
  const CounterRandom random(3, 1);
  std::vector<Frame> frames;
  std::vector<Eigen::Vector2d> truth;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    truth.emplace_back(-22.0 + 44.0 * random.uniform(2 * k), -16.0 + 32.0 * random.uniform(2 * k + 1));
    test::Canvas canvas(scene.camera, kBoard);
    canvas.spot(truth.back() - 0.5 * streak_mm, truth.back() + 0.5 * streak_mm, kSpotSigmaMm, height_gray,
                kLensPx);
    frames.push_back(scene.frame(canvas, k));
  }
  const SpotTrack track = scene.track(std::move(frames));
  SpotErrors errors;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    if (!track.frames[i].spot_W_mm) {
      ++errors.dark;
      continue;
    }
    const Eigen::Vector2d d = *track.frames[i].spot_W_mm - truth[i];
    errors.x.push_back(d.x());
    errors.y.push_back(d.y());
    errors.told.push_back(track.frames[i].spot_sigma_mm);
  }
  return errors;
}

void expectGoodSpots(const char* name, const SpotErrors& errors, double sigma_limit_mm) {
  const test::Statistics x = test::statisticsOf(errors.x);
  const test::Statistics y = test::statisticsOf(errors.y);
  const double told = test::statisticsOf(errors.told).mean;
  std::printf("  %s: bias %.2f %.2f um, sigma %.2f %.2f um, told %.2f um, dark %d\n", name, 1e3 * x.mean,
              1e3 * y.mean, 1e3 * x.sigma, 1e3 * y.sigma, 1e3 * told, errors.dark);
  EXPECT_EQ(errors.dark, 0);
  const double standard_error = sigma_limit_mm / std::sqrt(static_cast<double>(errors.x.size()));
  EXPECT_LT(std::abs(x.mean), 0.0003 + 3.0 * standard_error);
  EXPECT_LT(std::abs(y.mean), 0.0003 + 3.0 * standard_error);
  EXPECT_LT(std::max(x.sigma, y.sigma), sigma_limit_mm);
  // The stated uncertainty covers the two axes together.
  const double rms = std::sqrt(0.5 * (x.sigma * x.sigma + y.sigma * y.sigma));
  EXPECT_GT(told, 0.6 * rms);
  EXPECT_LT(told, 1.6 * rms);
}

TEST(SpotTrack, FindsARestingSpotAnywhere) {
  expectGoodSpots("at rest", measureSpots({0, 0}, 120, 100), 0.0025);
}
TEST(SpotTrack, FindsAFaintSpot) { expectGoodSpots("faint", measureSpots({0, 0}, 30, 100), 0.010); }
TEST(SpotTrack, ToleratesSaturation) { expectGoodSpots("saturated", measureSpots({0, 0}, 900, 100), 0.0025); }
TEST(SpotTrack, TakesTheMiddleOfAStreak) {
  expectGoodSpots("streak along x", measureSpots({0.5, 0.0}, 300, 80), 0.004);
  expectGoodSpots("streak aslant", measureSpots({-0.7, 0.7}, 400, 80), 0.006);
  expectGoodSpots("saturated streak", measureSpots({0.3, 0.9}, 2500, 80), 0.010);
}

TEST(SpotTrack, DarkFramesHaveNoSpot) {
  Scene scene;
  scene.print = fourMarks();
  std::vector<Frame> frames;
  for (std::uint64_t i = 0; i < 60; ++i) {
    frames.push_back(scene.frame(scene.web({-10.0 + 0.2 * static_cast<double>(i), 0.4}, 0.01), i));
  }
  for (const FrameMeasurement& frame : scene.track(std::move(frames)).frames) {
    EXPECT_FALSE(frame.spot_W_mm) << frame.sequence;
  }
}

TEST(SpotTrack, AHotPixelIsNoSpot) {
  const Scene scene;
  test::Canvas canvas(scene.camera, kBoard);
  canvas.pixel(200, 150, 255.0);
  canvas.pixel(401, 77, 200.0);
  const SpotTrack dark = scene.track({scene.frame(canvas, 0)});
  EXPECT_FALSE(dark.frames[0].spot_W_mm);
  canvas.spot({5.0, 5.0}, {5.0, 5.0}, kSpotSigmaMm, 60.0, kLensPx);
  const SpotTrack lit = scene.track({scene.frame(canvas, 1)});
  ASSERT_TRUE(lit.frames[0].spot_W_mm);
  EXPECT_LT((*lit.frames[0].spot_W_mm - Eigen::Vector2d(5.0, 5.0)).norm(), 0.02);
}

TEST(SpotTrack, FramesThatAreMissingAreCounted) {
  const Scene scene;
  std::vector<Frame> frames;
  const test::Canvas canvas(scene.camera, kBoard);
  for (const std::uint64_t sequence : {5U, 6U, 9U, 10U, 10U, 12U})
    frames.push_back(scene.frame(canvas, sequence));
  EXPECT_EQ(scene.track(std::move(frames)).frames_lost, 2U + 1U + 1U);
}

TEST(SpotTrack, MarksTellThePoseOfTheSheet) {
  Scene scene;
  scene.print = fourMarks();
  std::vector<Frame> frames;
  std::vector<Eigen::Vector2d> truth;
  constexpr double kAngle = 0.012;
  for (std::uint64_t i = 0; i < 40; ++i) {
    truth.emplace_back(-14.0 + 0.2 * static_cast<double>(i) + 0.013, 0.731);
    frames.push_back(scene.frame(scene.web(truth.back(), kAngle), i));
  }
  const SpotTrack track = scene.track(std::move(frames));
  std::vector<double> x, y, angle;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    ASSERT_EQ(track.frames[i].sheet.size(), 1U) << i;
    const SheetPose& pose = track.frames[i].sheet[0];
    EXPECT_EQ(pose.unit, 0);
    EXPECT_EQ(pose.marks, 4);
    EXPECT_LT(pose.residual_mm, 0.004);
    x.push_back(pose.p_WS_mm.x() - truth[i].x());
    y.push_back(pose.p_WS_mm.y() - truth[i].y());
    angle.push_back(pose.angle_rad - kAngle);
  }
  const auto sx = test::statisticsOf(x);
  const auto sy = test::statisticsOf(y);
  const auto sa = test::statisticsOf(angle);
  std::printf("  sheet: bias %.2f %.2f um, sigma %.2f %.2f um, angle %.1f / %.1f urad\n", 1e3 * sx.mean,
              1e3 * sy.mean, 1e3 * sx.sigma, 1e3 * sy.sigma, 1e6 * sa.mean, 1e6 * sa.sigma);
  EXPECT_LT(std::abs(sx.mean), 0.001);
  EXPECT_LT(std::abs(sy.mean), 0.001);
  EXPECT_LT(std::max(sx.sigma, sy.sigma), 0.003);
  EXPECT_LT(std::abs(sa.mean), 100e-6);
}

TEST(SpotTrack, UnitsComeAndGoInOrder) {
  Scene scene;
  scene.print = fourMarks(3, 40.0);
  std::vector<Frame> frames;
  std::vector<Eigen::Vector2d> truth;
  constexpr double kStepMm = 2.0;
  scene.speed_mm_s = kStepMm / scene.period_s;
  for (std::uint64_t i = 0; i < 95; ++i) {
    truth.emplace_back(-65.0 + kStepMm * static_cast<double>(i), -0.4);
    frames.push_back(scene.frame(scene.web(truth.back(), -0.004), i));
  }
  const SpotTrack track = scene.track(std::move(frames));
  std::vector<int> seen(3, 0);
  int without = 0;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    int expected = 0;
    for (int unit = 0; unit < 3; ++unit) {
      for (const RegistrationMark& mark : scene.print.marks) {
        const Eigen::Vector2d p_S = mark.p_SM_mm - Eigen::Vector2d(unit * 40.0, 0.0);
        expected += scene.camera.pixelIfSeen(truth[i] + turned(p_S, -0.004), 28.0) ? 1 : 0;
      }
    }
    int marks = 0;
    for (const SheetPose& pose : track.frames[i].sheet) {
      marks += pose.marks;
      ++seen[static_cast<std::size_t>(pose.unit)];
      const Eigen::Vector2d p_WS = truth[i] - turned({pose.unit * 40.0, 0.0}, -0.004);
      if (pose.marks > 1) {
        EXPECT_LT((pose.p_WS_mm - p_WS).norm(), 0.02) << "frame " << i << " unit " << pose.unit;
      } else {
        EXPECT_LT((pose.p_WS_mm - p_WS).norm(), 0.05) << "frame " << i << " unit " << pose.unit;
        EXPECT_TRUE(std::isnan(pose.residual_mm));
      }
    }
    if (marks < expected) ++without;
  }
  for (const int n : seen) EXPECT_GT(n, 20);
  EXPECT_LE(without, 4);
}

TEST(SpotTrack, ALoneFirstMarkTellsNoPose) {
  Scene scene;
  scene.print = fourMarks();
  scene.print.marks = {{{25.0, -15.0}, 3.0}, {{5.0, -15.0}, 3.0}, {{4.0, 15.0}, 3.0}};
  constexpr double kAngle = 0.015;
  std::vector<Frame> frames;
  std::vector<Eigen::Vector2d> truth;
  for (std::uint64_t i = 0; i < 50; ++i) {
    truth.emplace_back(-56.0 + static_cast<double>(i), 0.0);
    frames.push_back(scene.frame(scene.web(truth.back(), kAngle), i));
  }
  scene.speed_mm_s = 1000.0;
  const SpotTrack track = scene.track(std::move(frames));
  int posed = 0;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    for (const SheetPose& pose : track.frames[i].sheet) {
      ++posed;
      EXPECT_LT((pose.p_WS_mm - truth[i]).norm(), 0.05) << i;
    }
  }
  EXPECT_GT(posed, 15);
  EXPECT_LT(posed, 35);  // The first mark alone is in view for the frames before.
}

TEST(SpotTrack, AMissingMarkAndDirtDoNotDeceive) {
  Scene scene;
  scene.print = fourMarks(2, 60.0);
  std::vector<Frame> frames;
  std::vector<Eigen::Vector2d> truth;
  for (std::uint64_t i = 0; i < 60; ++i) {
    truth.emplace_back(-42.0 + 0.8 * static_cast<double>(i), 0.2);
    test::Canvas canvas = scene.web(truth.back(), 0.005, 0, 1);
    canvas.disc(truth.back() + Eigen::Vector2d(14.0, 3.0), 3.0, 35.0);  // round as a mark
    canvas.shape({truth.back() + Eigen::Vector2d(8.0, -6.0), truth.back() + Eigen::Vector2d(13.0, -4.0)},
                 30.0, [](const Eigen::Vector2d&) { return true; });
    frames.push_back(scene.frame(canvas, i));
  }
  scene.speed_mm_s = 800.0;
  const SpotTrack track = scene.track(std::move(frames));
  int posed = 0;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    for (const SheetPose& pose : track.frames[i].sheet) {
      if (pose.marks < 2) continue;
      ++posed;
      EXPECT_LT((pose.p_WS_mm - truth[i] + turned({pose.unit * 60.0, 0.0}, 0.005)).norm(), 0.02) << i;
    }
  }
  EXPECT_GT(posed, 25);
}

TEST(SpotTrack, ASpotOnAMarkSpoilsNeither) {
  for (const double height : {70.0, 300.0}) {
    Scene scene;
    scene.print = fourMarks();
    std::vector<Frame> frames;
    std::vector<Eigen::Vector2d> web;
    std::vector<Eigen::Vector2d> spot;
    for (std::uint64_t i = 0; i < 60; ++i) {
      web.emplace_back(-14.0 + 0.02 * static_cast<double>(i), 0.3);
      // The spot walks over the first mark, from 3 mm before to 3 mm behind it.
      spot.push_back(web.back() + scene.print.marks[1].p_SM_mm +
                     Eigen::Vector2d(-3.0 + 0.1 * static_cast<double>(i), 0.37));
      test::Canvas canvas = scene.web(web.back(), 0.0);
      canvas.spot(spot.back(), spot.back(), kSpotSigmaMm, height, kLensPx);
      frames.push_back(scene.frame(canvas, i));
    }
    scene.speed_mm_s = 20.0;
    const SpotTrack track = scene.track(std::move(frames));
    int dark = 0;
    double worst_pose = 0.0;
    double worst_spot = 0.0;
    for (std::size_t i = 0; i < track.frames.size(); ++i) {
      ASSERT_EQ(track.frames[i].sheet.size(), 1U) << i;
      EXPECT_GE(track.frames[i].sheet[0].marks, 3);
      worst_pose = std::max(worst_pose, (track.frames[i].sheet[0].p_WS_mm - web[i]).norm());
      if (!track.frames[i].spot_W_mm) {
        ++dark;
        continue;
      }
      worst_spot = std::max(worst_spot, (*track.frames[i].spot_W_mm - spot[i]).norm());
    }
    std::printf("  spot of height %.0f on a mark: worst pose %.1f um, worst spot %.1f um, dark %d of 60\n",
                height, 1e3 * worst_pose, 1e3 * worst_spot, dark);
    EXPECT_LT(worst_pose, 0.008);
    EXPECT_LT(worst_spot, 0.015);
    EXPECT_LE(dark, 6);  // The rim hides a glow that does not outshine the board.
  }
}

TEST(SpotTrack, IsTheSameAtAnyNumberOfThreads) {
  Scene scene;
  scene.print = fourMarks(2);
  std::vector<Frame> frames;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Eigen::Vector2d p_WS(-40.0 + static_cast<double>(i), 0.0);
    test::Canvas canvas = scene.web(p_WS, 0.002);
    if (i % 3 != 0) canvas.spot({1.0, 2.0}, {1.1, 2.3}, kSpotSigmaMm, 150.0, kLensPx);
    frames.push_back(scene.frame(canvas, i));
  }
  scene.speed_mm_s = 1000.0;
  const SpotTrack one = scene.track(frames, 1);
  const SpotTrack two = scene.track(frames, 2);
  ASSERT_EQ(one.frames.size(), two.frames.size());
  for (std::size_t i = 0; i < one.frames.size(); ++i) {
    EXPECT_EQ(one.frames[i].spot_W_mm, two.frames[i].spot_W_mm);
    EXPECT_EQ(one.frames[i].spot_sigma_mm, two.frames[i].spot_sigma_mm);
    ASSERT_EQ(one.frames[i].sheet.size(), two.frames[i].sheet.size());
    for (std::size_t k = 0; k < one.frames[i].sheet.size(); ++k) {
      EXPECT_EQ(one.frames[i].sheet[k].p_WS_mm, two.frames[i].sheet[k].p_WS_mm);
      EXPECT_EQ(one.frames[i].sheet[k].angle_rad, two.frames[i].sheet[k].angle_rad);
      EXPECT_EQ(one.frames[i].sheet[k].marks, two.frames[i].sheet[k].marks);
    }
  }
}

TEST(SpotTrack, ReportsItsSpeedOnLargeFrames) {
  Scene scene;
  scene.camera = test::tiltedCamera(1800, 1800, kPitchMm);
  scene.print = fourMarks(3, 50.0);
  std::vector<Frame> frames;
  test::Canvas canvas = scene.web({40.0, 0.0}, 0.0);
  canvas.spot({1.0, 2.0}, {1.2, 2.0}, kSpotSigmaMm, 250.0, kLensPx);
  const Frame first = scene.frame(canvas, 0);
  for (std::uint64_t i = 0; i < 60; ++i) {
    Frame copy = first;
    copy.sequence = i;
    copy.start_s = static_cast<double>(i) * 0.001;
    frames.push_back(std::move(copy));
  }
  test::ReadyFrames source(std::move(frames));
  const std::clock_t begin = std::clock();
  const SpotTrack track = trackSpot(source, scene.camera, scene.print, {1, 0.0});
  const double took_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("  %.2f ms of processor per 1800 x 1800 frame; %zu units, %d marks\n", took_ms / 60.0,
              track.frames.back().sheet.size(), track.frames.back().sheet[0].marks);
  EXPECT_EQ(track.frames.back().sheet.size(), 3U);
  EXPECT_TRUE(track.frames.back().spot_W_mm);
}

TEST(SpotTrack, RefusesFramesOfAnotherCamera) {
  Scene scene;
  test::ReadyFrames source({Frame{GrayImage(100, 100), 0, 0.0, 1e-5}});
  EXPECT_THROW(trackSpot(source, scene.camera, scene.print, {}), std::invalid_argument);
}

Frame cutOut(const Frame& whole, const PixelWindow& window) {
  Frame part = whole;
  part.image = GrayImage(window.width, window.height);
  part.image.left = window.left;
  part.image.top = window.top;
  for (int r = window.top; r <= window.bottom(); ++r) {
    for (int c = window.left; c <= window.right(); ++c) part.image.at(c, r) = whole.image.at(c, r);
  }
  return part;
}

/// Marks that the window cannot show are not missing: the sheet lies where those in it say.
TEST(SpotTrack, AWindowThatShowsOneRowOfMarksTellsThePlaceOfTheSheet) {
  Scene scene;
  scene.print.units = 1;
  scene.print.pitch_mm = 100.0;
  scene.print.marks = {{{-20.0, -14.0}, 3.0},
                       {{-20.0, 14.0}, 3.0},
                       {{5.0, -14.0}, 3.0},
                       {{5.0, 14.0}, 3.0},
                       {{-8.0, 14.0}, 3.0}};
  SpotTrackOptions options;
  for (const PixelWindow& window : {PixelWindow{0, 0, 640, 240}, PixelWindow{0, 240, 640, 240}}) {
    std::vector<Frame> frames;
    for (std::uint64_t i = 0; i < 4; ++i) {
      const Frame whole = scene.frame(scene.web({3.0, 0.5}, 0.0), i);
      frames.push_back(cutOut(whole, window));
    }
    options.window = window;
    test::ReadyFrames source(std::move(frames));
    const SpotTrack track = trackSpot(source, scene.camera, scene.print, options);
    for (const FrameMeasurement& frame : track.frames) {
      ASSERT_EQ(frame.sheet.size(), 1U);
      EXPECT_LT((frame.sheet[0].p_WS_mm - Eigen::Vector2d(3.0, 0.5)).norm(), 0.01) << window.top;
    }
    EXPECT_TRUE(track.problems.empty()) << track.problems.front();
  }
}

/// A camera that reads out one window for good: what is measured there does not move.
TEST(SpotTrack, AWindowMeasuresWhatTheWholePictureDoes) {
  Scene scene;
  scene.print = fourMarks(1, 50.0);
  std::vector<Frame> whole;
  std::vector<Frame> cut;
  const PixelWindow window{200, 120, 260, 240};
  for (std::uint64_t i = 0; i < 6; ++i) {
    test::Canvas canvas = scene.web({0.1 * static_cast<double>(i), 0.0}, 0.0);
    canvas.spot({1.0, 2.0}, {1.2, 2.0}, kSpotSigmaMm, 250.0, kLensPx);
    Frame frame = scene.frame(canvas, i);
    cut.push_back(cutOut(frame, window));
    whole.push_back(std::move(frame));
  }
  SpotTrackOptions options;
  test::ReadyFrames all(whole);
  const SpotTrack expected = trackSpot(all, scene.camera, scene.print, options);
  options.window = window;
  test::ReadyFrames parts(cut);
  const SpotTrack track = trackSpot(parts, scene.camera, scene.print, options);
  ASSERT_EQ(track.frames.size(), expected.frames.size());
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    ASSERT_TRUE(track.frames[i].spot_W_mm);
    EXPECT_LT((*track.frames[i].spot_W_mm - *expected.frames[i].spot_W_mm).norm(),
              0.2 * expected.frames[i].spot_sigma_mm);
  }
  options.window->left = 199;
  test::ReadyFrames elsewhere(cut);
  EXPECT_THROW(trackSpot(elsewhere, scene.camera, scene.print, options), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::vision
