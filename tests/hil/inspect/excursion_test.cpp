// SPDX-License-Identifier: Apache-2.0
// Place of the spot on the sheet, and its excursions along x.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hil/inspect/evidence/spot_association.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

const CutResult& cutOf(const InspectionResult& result, int unit, int entity) {
  for (const CutResult& cut : result.cuts) {
    if (cut.unit == unit && cut.entity == entity && std::isfinite(cut.drift_mm)) return cut;
  }
  throw std::out_of_range("no such cut");
}

TEST(Excursion, ABowWithoutADriftFails) {
  // The belt speeds up evenly; the excursion is the remainder over the mean speed.
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine, [](double t_s) {
    const double share = t_s / 0.119;
    return Eigen::Vector2d(0.15 * 4.0 * share * (1.0 - share), 0.0);
  });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(result, "stillness_peak").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "stillness_peak").subject, "unit 1, E5");
  const CutResult& cut = cutOf(result, 1, kCreaseLine);
  EXPECT_NEAR(cut.offset_mm, 0.1, 2.0 * cut.offset_sigma_mm);
  EXPECT_NEAR(cut.excursion_mm, 0.1, cut.excursion_U_mm);
  EXPECT_NEAR(cut.drift_mm, 0.0, 2.0 * cut.drift_sigma_mm);
  EXPECT_LT(cut.drift_sigma_mm, 0.002) << "motion is no noise";
}

TEST(Excursion, AnOffsetIsNone) {
  SyntheticRun run;
  run.shiftSpot(0, kCreaseLine, [](double) { return Eigen::Vector2d(-0.02, 0.0); });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stillness_peak").verdict, Verdict::kPass);
  const CutResult& cut = cutOf(result, 0, kCreaseLine);
  EXPECT_NEAR(cut.offset_mm, -0.02, 2.0 * cut.offset_sigma_mm);
  EXPECT_NEAR(cut.drift_mm, 0.0, 2.0 * cut.drift_sigma_mm);
}

TEST(Excursion, AFrameThatWasLitInPartTellsNothing) {
  SyntheticRun run;
  const CutResult even = cutOf(run.inspected(), 0, kCreaseLine);
  run.shiftSpot(0, kCreaseLine, [](double t_s) { return Eigen::Vector2d(t_s < 5e-4 ? 0.045 : 0.0, 0.0); });
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (std::abs(frame.mid_s - even.start_s) < 1e-6) frame.spot_sigma_mm = 0.03;
  }
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stillness_peak").verdict, Verdict::kPass);
  EXPECT_EQ(cutOf(result, 0, kCreaseLine).frames, even.frames - 1);
}

TEST(Excursion, CalibrationOfTheCameraIsPartOfTheMeanPlaceAndNotOfTheStraying) {
  SyntheticRun run;
  const auto cut = [&] { return cutOf(run.inspected(), 0, kCreaseLine); };
  vision::CameraCalibration& camera = *run.evidence.spot_calibration;
  camera.error_modes.clear();
  const CutResult known = cut();
  // The mode is the principal point along x: all places shift alike.
  camera.error_modes.emplace_back(Eigen::Matrix<double, vision::CameraCalibration::kParameters, 1>::Zero());
  camera.error_modes.back()[2] = 0.03;
  const double shift_mm = camera.mapError(0, {0.0, 0.0}).norm();
  ASSERT_GT(shift_mm, known.offset_sigma_mm);
  const CutResult unknown = cut();
  EXPECT_NEAR(unknown.offset_sigma_mm, std::hypot(known.offset_sigma_mm, shift_mm), 0.02 * shift_mm);
  EXPECT_NEAR(unknown.excursion_U_mm, known.excursion_U_mm, 0.02 * known.excursion_U_mm);
}

TEST(Excursion, IsAsUncertainAsAPlaceWithinAPixel) {
  SyntheticRun run;
  run.shiftSpot(0, kCreaseLine, [](double t_s) { return Eigen::Vector2d(1.5 * t_s / 0.119, 0.0); });
  const auto cut = [&] { return cutOf(run.inspected(), 0, kCreaseLine); };
  const double pixel_mm = run.evidence.spot_calibration->pitchMm();
  const double with_pixel_mm = cut().excursion_U_mm;
  run.evidence.spot_calibration.reset();
  const double without_mm = cut().excursion_U_mm;
  EXPECT_NEAR(with_pixel_mm, std::hypot(without_mm, 2.0 * 0.006 * pixel_mm), 0.02 * with_pixel_mm);
  // Frames are noisy by 2 um each; a place that stands out by itself is known no better.
  EXPECT_GT(without_mm, 0.8 * 2.0 * 0.002);
  EXPECT_LT(without_mm, 1.1 * 2.0 * 0.002);
}

TEST(Excursion, ASpotThatLeavesItsLineAndComesBackIsStillMeasured) {
  for (const double far_mm : {0.95, 1.5}) {
    SyntheticRun run;
    run.shiftSpot(0, kCreaseLine, [&](double t_s) {
      return Eigen::Vector2d(far_mm * std::sin(std::numbers::pi * t_s / 0.119), 0.0);
    });
    const auto result = run.inspected();
    const CutResult& cut = cutOf(result, 0, kCreaseLine);
    EXPECT_EQ(cut.frames, 120);
    EXPECT_EQ(cut.lost, 0);
    EXPECT_NEAR(cut.offset_mm, far_mm * 2.0 / std::numbers::pi, 0.01);
    EXPECT_NEAR(cut.peak_mm, far_mm, cut.peak_U_mm + 1e-3);
    EXPECT_EQ(checkOf(result, "stillness_peak").verdict, Verdict::kFail);
  }
}

TEST(Excursion, BeyondTheSearchForLinesASpotThatDoesNotComeBackFailsAndIsNotMeasured) {
  SyntheticRun run;
  run.shiftSpot(0, kCreaseLine, [](double t_s) { return Eigen::Vector2d(1.5 * t_s / 0.119, 0.0); });
  const auto result = run.inspected();
  const CutResult& cut = cutOf(result, 0, kCreaseLine);
  EXPECT_GT(cut.lost, 20);
  EXPECT_EQ(cut.frames + cut.lost, 120);
  EXPECT_LE(cut.peak_mm, kSearch_mm);
  EXPECT_EQ(checkOf(result, "stillness_peak").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kFail);
}

TEST(Excursion, ASpotThatWentAnotherWayBeforeItCameBackIsNotMeasured) {
  // Far to one side and back within a third of the line: that may have been another line.
  SyntheticRun run;
  run.shiftSpot(0, kCreaseLine, [](double t_s) {
    return Eigen::Vector2d(9.0 * std::pow(std::sin(std::numbers::pi * t_s / 0.119), 6.0), 0.0);
  });
  const auto result = run.inspected();
  EXPECT_GT(cutOf(result, 0, kCreaseLine).lost, 50);
  EXPECT_LE(cutOf(result, 0, kCreaseLine).peak_mm, kSearch_mm);
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kFail);
}

TEST(Excursion, ASpotThatNeverComesBackIsMeasuredToTheEnd) {
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine, [](double t_s) { return Eigen::Vector2d(0.7 * t_s / 0.119, 0.0); });
  const CutResult cut = cutOf(run.inspected(), 1, kCreaseLine);
  EXPECT_EQ(cut.frames, 120);
  EXPECT_NEAR(cut.drift_mm, 0.7, 2.0 * cut.drift_sigma_mm + 1e-3);
}

}  // namespace
}  // namespace kerfbench::inspect
