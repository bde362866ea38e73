// SPDX-License-Identifier: Apache-2.0
// The spot camera read out by windows around spot and marks, as the pins have them.
#include "hil/vision/spot/spot_windows.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/camera/twin/twin_frames.h"
#include "hil/vision/spot/spot_track.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/spot_twin.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr int kFrames = 160;
constexpr double kBelt_mm_s = 60.0;

/// Two units on the way; the second comes into view while the first leaves it.
PrintLayout print() {
  PrintLayout print;
  print.units = 2;
  print.pitch_mm = 22.0;
  print.marks = {{{-4.0, -9.0}, 2.0}, {{5.0, -9.0}, 2.0}, {{4.0, 9.5}, 2.0}};
  return print;
}

Vector2d spotAt(double time_s) { return {6.0 * std::sin(25.0 * time_s), 4.0 * std::cos(40.0 * time_s)}; }

std::vector<twin::Exposure> exposures() {
  std::vector<twin::Exposure> all;
  for (int i = 0; i < kFrames; ++i) {
    const double start_s = 1e-3 * i;
    twin::Exposure& exposure = all.emplace_back();
    exposure.sequence = static_cast<std::uint64_t>(i);
    exposure.start_s = start_s;
    for (int k = 0; k < 5; ++k) {
      const double time_s = start_s + 2e-4 * (k + 0.5) / 5;
      exposure.samples.push_back({.p_WQ_mm = spotAt(time_s),
                                  .radius_mm = test::kSpotRadiusMm,
                                  .power_w = i < 20 || i % 40 == 7 ? 0.0 : 25.0,
                                  .p_WS_mm = {kBelt_mm_s * time_s - 2.0, 0.4}});
    }
  }
  return all;
}

twin::CameraDescription camera() {
  twin::CameraDescription camera = test::spotCamera();
  camera.exposure_s = 2e-4;
  camera.read_out = {.row_s = 5e-6, .link_bytes_per_s = 2e8};  // A whole picture takes 1.3 periods.
  return camera;
}

/// Where the pins have the spot; the head is off by as much.
BeamAim aimOff(const Vector2d& off_mm) {
  return [off_mm](double from_s, double to_s) -> std::optional<Eigen::AlignedBox2d> {
    Eigen::AlignedBox2d box;
    for (int i = 0; i <= 4; ++i) box.extend(spotAt(from_s + (to_s - from_s) * i / 4) + off_mm);
    return box;
  };
}

SpotTrack trackBy(const BeamAim& aim, int threads = 1, const PrintLayout& layout = print()) {
  camera::TwinFrameSource source(twin::SpotCamera(camera(), layout, test::kGlowGrayPerW, 3), exposures(),
                                 threads);
  SpotTrackOptions options{threads, kBelt_mm_s};
  options.aim = aim;
  return trackSpot(source, test::calibrationOf(camera()), layout, options);
}

TEST(SpotWindows, TheTrackIsThatOfWholePictures) {
  const SpotTrack whole = trackBy({});
  const SpotTrack windows = trackBy(aimOff({1.2, -1.4}));
  ASSERT_EQ(whole.frames.size(), static_cast<std::size_t>(kFrames));
  // The first picture was whole, to find the marks by; the camera was not ready for the second.
  ASSERT_EQ(windows.frames.size(), whole.frames.size() - 2);
  EXPECT_TRUE(windows.problems.empty()) << windows.problems.front();
  EXPECT_EQ(windows.frames_lost, 0U);
  int spots = 0;
  int poses = 0;
  double squares = 0.0;
  for (std::size_t i = 0; i < windows.frames.size(); ++i) {
    const FrameMeasurement& a = whole.frames[i + 2];
    const FrameMeasurement& b = windows.frames[i];
    EXPECT_EQ(a.mid_s, b.mid_s);
    EXPECT_EQ(b.sequence, i + 1);
    ASSERT_EQ(a.spot_W_mm.has_value(), b.spot_W_mm.has_value()) << i;
    if (a.spot_W_mm) {
      EXPECT_LT((*a.spot_W_mm - *b.spot_W_mm).norm(), 0.2 * a.spot_sigma_mm) << i;
      EXPECT_NEAR(b.spot_sigma_mm, a.spot_sigma_mm, 0.15 * a.spot_sigma_mm);
      ++spots;
    }
    ASSERT_EQ(a.sheet.size(), b.sheet.size()) << i;
    for (std::size_t k = 0; k < a.sheet.size(); ++k) {
      EXPECT_EQ(a.sheet[k].unit, b.sheet[k].unit);
      EXPECT_EQ(a.sheet[k].marks, b.sheet[k].marks) << i;
      // Marks are looked at with the light of pictures before, as many as there are yet: not the same ones,
      // and each has noise of its own.
      const double noise_mm = std::sqrt(a.sheet[k].covariance.topLeftCorner<2, 2>().trace());
      const double noises = (a.sheet[k].p_WS_mm - b.sheet[k].p_WS_mm).norm() / noise_mm;
      EXPECT_LT(noises, 3.0) << i;
      squares += noises * noises;
      ++poses;
    }
  }
  EXPECT_EQ(spots, 137);
  EXPECT_GT(poses, 170);  // Both units are seen.
  EXPECT_LT(std::sqrt(squares / poses), 0.3);
}

TEST(SpotWindows, TheTrackIsTheSameAtAnyNumberOfThreads) {
  const SpotTrack one = trackBy(aimOff({0.3, 0.2}));
  const SpotTrack three = trackBy(aimOff({0.3, 0.2}), 3);
  ASSERT_EQ(one.frames.size(), three.frames.size());
  for (std::size_t i = 0; i < one.frames.size(); ++i) {
    EXPECT_EQ(one.frames[i].spot_W_mm, three.frames[i].spot_W_mm);
    ASSERT_EQ(one.frames[i].sheet.size(), three.frames[i].sheet.size());
    for (std::size_t k = 0; k < one.frames[i].sheet.size(); ++k)
      EXPECT_EQ(one.frames[i].sheet[k].p_WS_mm, three.frames[i].sheet[k].p_WS_mm);
  }
}

/// Four rows of marks are more than the camera reads in a period: they are read in turns, and none is missed.
TEST(SpotWindows, MarksThatCannotAllBeReadAreReadInTurns) {
  PrintLayout many = print();
  for (const double y_mm : {-5.5, -2.0, 2.5, 6.0}) many.marks.push_back({{-2.0 + 0.3 * y_mm, y_mm}, 2.0});
  camera::TwinFrameSource source(twin::SpotCamera(camera(), many, test::kGlowGrayPerW, 3), exposures(), 1);
  SpotTrackOptions options{1, kBelt_mm_s};
  options.aim = aimOff({0.0, 0.0});
  options.read_out = camera().read_out;
  options.frame_period_s = camera().frame_period_s;
  const SpotTrack track = trackSpot(source, test::calibrationOf(camera()), many, options);
  EXPECT_TRUE(track.problems.empty()) << track.problems.front();
  ASSERT_EQ(track.frames.size(), static_cast<std::size_t>(kFrames) - 2) << "the camera was late";
  std::set<std::size_t> seen;
  std::size_t all = 0;
  for (const FrameMeasurement& frame : track.frames) {
    ASSERT_FALSE(frame.sheet.empty());
    seen.insert(frame.sheet.front().seen.begin(), frame.sheet.front().seen.end());
    all += frame.sheet.front().seen.size() == many.marks.size() ? 1 : 0;
  }
  EXPECT_EQ(seen.size(), many.marks.size());
  EXPECT_EQ(all, 0U);
}

bool tells(const SpotTrack& track, const std::string& words) {
  return std::ranges::any_of(track.problems, [&](const std::string& p) { return p.find(words) != p.npos; });
}

TEST(SpotWindows, ACameraWithoutTimeForAnyMarkIsTold) {
  camera::TwinFrameSource source(twin::SpotCamera(camera(), print(), test::kGlowGrayPerW, 3), exposures(), 1);
  SpotTrackOptions options{1, kBelt_mm_s};
  options.aim = aimOff({0.0, 0.0});
  options.read_out = {.row_s = 12e-6,
                      .link_bytes_per_s = 0.0};  // 81 rows; the spot alone takes more than 50.
  options.frame_period_s = camera().frame_period_s;
  const SpotTrack track = trackSpot(source, test::calibrationOf(camera()), print(), options);
  EXPECT_TRUE(tells(track, "had no time to read a printed mark beside the spot: it needs 12 us for a row"));
}

TEST(SpotWindows, ACameraThatIsLateInEachFrameIsTold) {
  twin::CameraDescription slow = camera();
  slow.read_out.row_s = 8e-6;  // 1.3 periods for spot and marks, and as much as its data sheet does not say.
  camera::TwinFrameSource source(twin::SpotCamera(slow, print(), test::kGlowGrayPerW, 3), exposures(), 1);
  SpotTrackOptions options{1, kBelt_mm_s};
  options.aim = aimOff({0.0, 0.0});
  options.read_out = camera().read_out;
  options.frame_period_s = slow.frame_period_s;
  const SpotTrack track = trackSpot(source, test::calibrationOf(slow), print(), options);
  EXPECT_TRUE(tells(track, "The spot camera gives a frame each 2 ms, and not each 1 ms"));
  EXPECT_FALSE(tells(trackBy(aimOff({0.0, 0.0})), "not ready in time"));
}

TEST(SpotWindows, AFrameThatIsLostBeforeTheMarksAreFoundIsNoneOfTheTrack) {
  // Marks come into view after 60 ms; the camera loses one of the whole pictures before.
  PrintLayout late = print();
  late.units = 1;
  for (RegistrationMark& mark : late.marks) mark.p_SM_mm.x() -= 25.0;
  twin::CameraDescription description = camera();
  description.link.dropped = {4};
  camera::TwinFrameSource source(twin::SpotCamera(description, late, test::kGlowGrayPerW, 3), exposures(), 1);
  SpotTrackOptions options{1, kBelt_mm_s};
  options.aim = aimOff({0.0, 0.0});
  const SpotTrack track = trackSpot(source, test::calibrationOf(description), late, options);
  ASSERT_GT(track.frames.size(), 10U);
  EXPECT_GT(track.frames.front().mid_s, 0.02);
  EXPECT_EQ(track.frames_lost, 0U);
}

/// A camera of 25 frames/s, and a belt that changes its speed between two of them: the marks are looked for
/// where the frame before has them.
TEST(SpotWindows, ABeltThatSpeedsUpIsFollowedByASlowCamera) {
  twin::CameraDescription slow = camera();
  slow.frame_period_s = 0.04;
  std::vector<twin::Exposure> all;
  for (int i = 0; i < 60; ++i) {
    const double start_s = 0.04 * i;
    twin::Exposure& exposure = all.emplace_back();
    exposure.sequence = static_cast<std::uint64_t>(i);
    exposure.start_s = start_s;
    const double x_mm = 20.0 * start_s - 4.0 * std::cos(2.5 * start_s) - 12.0;  // 10 to 30 mm/s, 25 mm/s².
    exposure.samples.push_back(
        {.p_WQ_mm = {0.0, 2.0}, .radius_mm = 0.105, .power_w = 25.0, .p_WS_mm = {x_mm, 0.4}});
  }
  const auto track = [&](const BeamAim& aim) {
    camera::TwinFrameSource source(twin::SpotCamera(slow, print(), test::kGlowGrayPerW, 3), all, 1);
    SpotTrackOptions options{1, 20.0};
    options.aim = aim;
    options.read_out = slow.read_out;
    options.frame_period_s = slow.frame_period_s;
    return trackSpot(source, test::calibrationOf(slow), print(), options);
  };
  const SpotTrack whole = track({});
  const SpotTrack windows = track([](double, double) {
    return std::optional<Eigen::AlignedBox2d>({Vector2d(0.0, 2.0), Vector2d(0.0, 2.0)});
  });
  ASSERT_EQ(windows.frames.size(), whole.frames.size() - 1);
  for (std::size_t i = 0; i < windows.frames.size(); ++i) {
    const FrameMeasurement& a = whole.frames[i + 1];
    const FrameMeasurement& b = windows.frames[i];
    ASSERT_EQ(a.sheet.size(), b.sheet.size()) << i;
    for (std::size_t k = 0; k < a.sheet.size(); ++k) {
      EXPECT_EQ(a.sheet[k].marks, b.sheet[k].marks) << i;
      // Marks are looked at with the light of the picture before: for the first it is another picture's, with
      // noise of its own.
      const double noise_mm = std::sqrt(a.sheet[k].covariance.topLeftCorner<2, 2>().trace());
      EXPECT_LT((a.sheet[k].p_WS_mm - b.sheet[k].p_WS_mm).norm(), i == 0 ? 3.0 * noise_mm : 2e-4) << i;
    }
  }
}

TEST(SpotWindows, ASpotThatIsDrivenOutOfItsWindowIsNotSeenAndTheSheetIs) {
  const SpotTrack track = trackBy(aimOff({7.0, 0.0}));
  int spots = 0;
  int without_sheet = 0;
  for (const FrameMeasurement& frame : track.frames) {
    spots += frame.spot_W_mm ? 1 : 0;
    without_sheet += frame.sheet.empty() ? 1 : 0;
  }
  EXPECT_EQ(spots, 0);
  EXPECT_EQ(without_sheet, 0);
}

TEST(SpotWindows, WithoutMarksInViewPicturesStayWholeAndTheCameraSlow) {
  PrintLayout far = print();
  for (RegistrationMark& mark : far.marks) mark.p_SM_mm.y() += 60.0;
  const SpotTrack track = trackBy(aimOff({0.0, 0.0}), 1, far);
  EXPECT_EQ(track.frames.size(), static_cast<std::size_t>(kFrames) / 2);
}

TEST(SpotWindows, WithoutPrintOnlyTheSpotIsReadOut) {
  const SpotTrack track = trackBy(aimOff({0.0, 0.0}), 1, test::noPrint());
  EXPECT_EQ(track.frames.size(), static_cast<std::size_t>(kFrames) - 2);
  EXPECT_EQ(std::ranges::count_if(track.frames, [](const auto& f) { return f.spot_W_mm.has_value(); }), 137);
}

bool holds(const PixelWindow& window, const Vector2d& pixel) {
  return pixel.x() >= window.left && pixel.x() <= window.right() && pixel.y() >= window.top &&
         pixel.y() <= window.bottom();
}

TEST(SpotWindows, ABandHoldsAMarkWhereverItIsOnItsWay) {
  const CameraCalibration calibration = test::calibrationOf(camera());
  const std::vector<SheetTracker::MarkPlace> places{{{40.0, -9.0}, 2.0, 0.0}, {{-60.0, 9.5}, 2.0, 0.0}};
  const std::vector<PixelWindow> bands = markBands(calibration, places);
  ASSERT_EQ(bands.size(), 2U);
  for (const double y_mm : {-9.0, 9.5}) {
    for (double x_mm = -15.0; x_mm <= 15.0; x_mm += 0.5) {
      for (const Vector2d& rim : {Vector2d(0, 1.5), Vector2d(0, -1.5)}) {
        const auto pixel = calibration.pixelIfSeen(Vector2d(x_mm, y_mm) + rim, 0.0);
        if (!pixel) continue;
        EXPECT_TRUE(holds(bands[0], *pixel) || holds(bands[1], *pixel)) << x_mm << ' ' << y_mm;
      }
    }
  }
  // A mark that no lens shows has none, and breaks nothing.
  CameraCalibration folded = calibration;
  folded.distortion = {-8.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_NO_THROW(
      static_cast<void>(markBands(folded, std::vector<SheetTracker::MarkPlace>{{{0.0, 400.0}, 2.0, 0.0}})));
  // Two rows of marks that nearly touch are one band.
  EXPECT_EQ(
      markBands(calibration, std::vector<SheetTracker::MarkPlace>{{{0, 0}, 2.0, 0.0}, {{0, 2.5}, 2.0, 0.0}})
          .size(),
      1U);
}

TEST(SpotWindows, AroundTheSpotThereIsRoomForAHeadThatIsOff) {
  const CameraCalibration calibration = test::calibrationOf(camera());
  const PixelWindow window = spotWindow(calibration, {Vector2d(-1.0, 0.0), Vector2d(2.0, 1.0)});
  for (const Vector2d& p_mm : {Vector2d(-3.0, -2.0), Vector2d(4.0, 3.0), Vector2d(0.0, 0.5)})
    EXPECT_TRUE(holds(window, calibration.pixelFromPlane(p_mm)));
  EXPECT_LT(window.area(), 85U * 65U);
  EXPECT_TRUE(spotWindow(calibration, {Vector2d(300.0, 0.0), Vector2d(301.0, 1.0)}).empty());
}

}  // namespace
}  // namespace kerfbench::vision
