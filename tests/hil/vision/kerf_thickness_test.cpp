// SPDX-License-Identifier: Apache-2.0
// Thick board: a kerf is a slit with walls, and a camera that looks aslant sees it displaced.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "hil/vision/scan/sight_depth.h"
#include "hil/vision/scan/sight_pairs.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using test::TwinCut;

constexpr double kThickness_mm = 0.4;

dieline::Curve lineOf(const Vector2d& from_mm, const Vector2d& to_mm) {
  return dieline::LineCurve{from_mm, to_mm};
}

enum class Walls { kUpright, kTapered };

/// Lines in both directions and aslant, up to the rim of the field, on board of 0.4 mm.
TwinCut thickCut(Walls walls) {
  TwinCut cut;
  cut.board.thickness_mm = kThickness_mm;
  if (walls == Walls::kUpright) cut.board.depth_curve = {{0.9, 0.0}, {1.0, 1.0}};
  cut.options.board_thickness_mm = kThickness_mm;
  cut.options.table_sigma_mm = 0.001;
  for (const double x : {-14.0, -6.0, 6.0, 14.0}) cut.add(lineOf({x, -13.0}, {x + 0.4, 13.0}));
  for (const double y : {-9.0, 0.5, 9.0}) cut.add(lineOf({-21.0, y}, {-15.5, y + 0.1}));
  for (const double y : {-9.0, 0.5, 9.0}) cut.add(lineOf({15.5, y}, {21.0, y + 0.1}));
  return cut;
}

/// The sheet in four tiles that overlap, read as the table says; each was taken `off_mm` beside it.
std::vector<camera::KerfTile> fourTiles(const TwinCut& cut, double off_mm = 0.0) {
  const twin::Sheet sheet = cut.sheet();
  std::vector<camera::KerfTile> tiles;
  double sign = 1.0;
  for (const double x : {-9.0, 9.0}) {
    for (const double y : {-7.0, 7.0}) {
      const Vector2d p_TV_mm(x, y);
      const Vector2d taken_mm = p_TV_mm + sign * off_mm * Vector2d(0.8, -0.6);
      tiles.push_back(
          {twin::KerfCamera(cut.camera, cut.print, cut.seed).render(sheet, 0, taken_mm, cut.lay()), p_TV_mm,
           0});
      sign = -sign;
    }
  }
  return tiles;
}

struct Errors {
  double worst_mm{};
  double rms_mm{};
  double covered{};  ///< Share of errors within what the scan states, k = 2.
};

/// Errors of all calipers away from joints, and whether what the scan says of them holds them.
Errors errorsOf(const TwinCut& cut, const KerfScan& scan) {
  const CameraCalibration camera = test::calibrationOf(cut.camera);
  Errors errors;
  std::size_t count = 0;
  std::size_t within = 0;
  for (const EntityKerf& kerf : scan.entities) {
    const dieline::Curve& curve = cut.dieline.entities.at(static_cast<std::size_t>(kerf.entity)).curve;
    for (const Caliper& c : kerf.calipers) {
      const bool end = c.station_mm < 0.3 || c.station_mm > kerf.calipers.back().station_mm - 0.3;
      if (!c.found || c.near_joint || end) continue;
      const double error_mm = std::abs(c.offset_mm - cut.truth(scan, c, curve, 0.0));
      const double slope = camera.sightSlope(c.p_V_mm).norm();
      const double U_mm = 2.0 * std::hypot(c.sigma_mm, kerf.depth_sigma_mm * slope) + 0.001;
      errors.worst_mm = std::max(errors.worst_mm, error_mm);
      errors.rms_mm += error_mm * error_mm;
      within += error_mm <= U_mm ? 1 : 0;
      ++count;
    }
  }
  errors.rms_mm = std::sqrt(errors.rms_mm / static_cast<double>(count));
  errors.covered = static_cast<double>(within) / static_cast<double>(count);
  return errors;
}

TEST(SightPairs, AreTakenOfLinesShorterThanAMillimetreToo) {
  TwinCut cut;
  constexpr std::size_t kLines = 6;
  for (std::size_t i = 0; i < kLines; ++i) {
    const double x_mm = 3.0 * static_cast<double>(i) - 7.5;
    cut.add(lineOf({x_mm, 0.0}, {x_mm, 0.9}));
  }
  const CameraCalibration camera = test::calibrationOf(cut.camera);
  const twin::Sheet sheet = cut.sheet();
  std::vector<TileView> views;
  for (const Vector2d& p_TV_mm : {Vector2d(-3.0, 0.0), Vector2d(3.0, 0.0)}) {
    views.push_back(viewTile(
        {twin::KerfCamera(cut.camera, cut.print, cut.seed).render(sheet, 0, p_TV_mm, cut.lay()), p_TV_mm, 0},
        camera, {}));
  }
  const TileIndex index(views, camera);
  const Eigen::Isometry2d X_TS = cut.lay();
  const PlaneMotion motion{X_TS.translation(), Eigen::Rotation2Dd(X_TS.linear()).angle()};
  const KerfPlan plan = planKerf(cut.dieline, cut.options);
  EXPECT_EQ(sightPairs(plan, {views, index, motion, camera, cut.options}).size(), kLines);
}

class ThickBoard : public ::testing::TestWithParam<Walls> {};

TEST_P(ThickBoard, OverlapsTellHowDeepAKerfIsSeen) {
  TwinCut cut = thickCut(GetParam());
  const std::vector<camera::KerfTile> tiles = fourTiles(cut);
  const KerfScan scan = cut.scan(tiles);
  EXPECT_THAT(scan.problems, ::testing::IsEmpty());
  const Errors errors = errorsOf(cut, scan);
  RecordProperty("worst_um", std::to_string(1e3 * errors.worst_mm));
  RecordProperty("depth_um", std::to_string(1e3 * scan.entities.front().depth_mm));
  EXPECT_LT(errors.worst_mm, 0.005);
  EXPECT_GT(errors.covered, 0.94);
  EXPECT_LT(scan.entities.front().depth_sigma_mm, 0.07 * kThickness_mm);
  // Read as if the board were thin, the same pictures are wrong by far more.
  cut.options.board_thickness_mm = 0.0;
  const Errors thin = errorsOf(cut, cut.scan(tiles));
  RecordProperty("thin_worst_um", std::to_string(1e3 * thin.worst_mm));
  EXPECT_GT(thin.worst_mm, 0.007);
  EXPECT_LT(thin.covered, 0.6);
}

TEST_P(ThickBoard, ATileAloneIsWithinWhatGeometryLeavesOpen) {
  const TwinCut cut = thickCut(GetParam());
  const KerfScan scan = cut.scan();
  const Errors errors = errorsOf(cut, scan);
  RecordProperty("worst_um", std::to_string(1e3 * errors.worst_mm));
  EXPECT_GT(errors.covered, 0.94);
  EXPECT_DOUBLE_EQ(scan.entities.front().depth_sigma_mm, expectedDepths(kThickness_mm).front().sigma_mm);
}

TEST_P(ThickBoard, EndsAreAsLongAsTheyWereCutThoughWallsHideThem) {
  const TwinCut cut = thickCut(GetParam());
  for (const KerfScan& scan : {cut.scan(), cut.scan(fourTiles(cut))}) {
    double found = 0.0;
    double within = 0.0;
    double sum_mm = 0.0;
    for (const LineEnd& end : scan.ends) {
      if (!end.found) continue;  // No tile sees ends at the rim whole.
      found += 1.0;
      within += std::abs(end.gap_mm) <= 2.0 * end.sigma_mm ? 1.0 : 0.0;
      sum_mm += end.gap_mm;
    }
    const double mean_mm = sum_mm / found;
    ASSERT_GE(found, 12.0);
    EXPECT_GT(within / found, 0.9) << 1e3 * mean_mm << " um on average";
    EXPECT_LT(std::abs(mean_mm), 0.003);
  }
}

INSTANTIATE_TEST_SUITE_P(Walls, ThickBoard, ::testing::Values(Walls::kUpright, Walls::kTapered),
                         [](const auto& walls) {
                           return walls.param == Walls::kUpright ? "Upright" : "Tapered";
                         });

TEST(ThickBoardByATelecentricLens, LooksThin) {
  TwinCut cut = thickCut(Walls::kTapered);
  cut.camera.telecentric_mm = 300.0;
  cut.camera.X_CP.linear() = Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Errors errors = errorsOf(cut, cut.scan());
  RecordProperty("worst_um", std::to_string(1e3 * errors.worst_mm));
  EXPECT_LT(errors.worst_mm, 0.002);
}

TEST(ThickBoardOnATable, ItsErrorsAreSeenWhereTilesOverlap) {
  const TwinCut cut = thickCut(Walls::kUpright);
  const double good_mm = cut.scan(fourTiles(cut)).tile_misfit_mm;
  const double off_mm = cut.scan(fourTiles(cut, 0.01)).tile_misfit_mm;
  RecordProperty("good_um", std::to_string(1e3 * good_mm));
  RecordProperty("off_um", std::to_string(1e3 * off_mm));
  EXPECT_LT(good_mm, 0.0015);
  EXPECT_GT(off_mm, 0.003);
}

TEST(SightDepth, FollowsFromPairsAndLeavesOutWhatDoesNotFit) {
  std::vector<SightPair> pairs;
  for (int i = 0; i < 60; ++i) {
    const double slope = 0.1 + 0.001 * i;
    pairs.push_back({.form = KerfForm::kThrough,
                     .tile = 0,
                     .other = 1,
                     .slope = slope,
                     .apart_mm = -0.22 * slope + (i % 2 == 0 ? 1.0 : -1.0) * 3e-4,
                     .sigma_mm = 3e-4});
  }
  const SightFit fit = sightDepths(pairs, 2, 0.4, 0.0005);
  EXPECT_NEAR(fit.depths.front().mm, 0.22, 2.5 * fit.depths.front().sigma_mm);
  EXPECT_LT(fit.depths.front().sigma_mm, 0.02);
  // Nothing was said of grooves.
  EXPECT_DOUBLE_EQ(fit.depths.back().mm, expectedDepths(0.4).back().mm);
  for (std::size_t i = 0; i < 6; ++i) pairs[10 * i].apart_mm += 0.05;
  const SightFit dirty = sightDepths(pairs, 2, 0.4, 0.0005);
  EXPECT_NEAR(dirty.depths.front().mm, fit.depths.front().mm, 0.005);
}

TEST(SightDepth, AGrooveEndsAnywhereFromTheFaceToTwiceItsMiddle) {
  const SightDepth shallow = expectedDepths(0.4)[static_cast<std::size_t>(KerfForm::kShallow)];
  EXPECT_NEAR(shallow.mm, 0.35 * 0.4, 1e-12);
  EXPECT_NEAR(shallow.sigma_mm, shallow.mm / std::sqrt(3.0), 0.02 * shallow.mm) << "rectangular";
}

TEST(SightDepth, IsNothingForThinBoard) {
  const SightFit fit = sightDepths({}, 1, 0.0, 0.0);
  EXPECT_EQ(fit.depths.front().mm, 0.0);
  EXPECT_EQ(fit.depths.front().sigma_mm, 0.0);
  // Nor do tiles that disagree tell a depth there: they disagree for another reason.
  std::vector<SightPair> pairs;
  for (int i = 0; i < 60; ++i)
    pairs.push_back({.tile = 0, .other = 1, .slope = 0.1, .apart_mm = 0.02, .sigma_mm = 3e-4});
  const SightFit apart = sightDepths(pairs, 2, 0.0, 0.0005);
  EXPECT_EQ(apart.depths.front().mm, 0.0);
  EXPECT_EQ(apart.depths.front().sigma_mm, 0.0);
  EXPECT_TRUE(std::isnan(apart.misfit_mm));
}

}  // namespace
}  // namespace kerfbench::vision
