// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/head_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware_under_test/planner/head/axes.h"
#include "twin/base/random.h"
#include "twin/optics/scan_head.h"
#include "twin/optics/surface.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

constexpr int kCount = static_cast<int>(kHeadParameterCount);

HeadDesign twoMirrors(bool y_first) {
  return {.throw_mm = 330.0, .mirror_spacing_mm = 22.0, .y_mirror_first = y_first, .lens = std::nullopt};
}

HeadDesign withLens() {
  HeadDesign design{.throw_mm = 430.0, .mirror_spacing_mm = 40.0, .y_mirror_first = false, .lens = {}};
  design.lens = LensDesign{430.0, -0.02, 0.01, 0.6};
  return design;
}

std::vector<HeadDesign> designs() { return {twoMirrors(false), twoMirrors(true), withLens()}; }

/// Departures of every kind, within the tolerances.
HeadVector departed(const HeadDesign& design, std::uint64_t seed) {
  const CounterRandom random(seed, 1);
  HeadVector departures = HeadTolerances().sigmas(design);
  for (int k = 0; k < kCount; ++k) departures[k] *= 2.0 * random.uniform(static_cast<std::uint64_t>(k)) - 1.0;
  return departures;
}

TEST(HeadModel, AsDrawnIsTheFormulaOfChengEtAl) {
  const NominalHead nominal{
      .throw_mm = 330.0, .mirror_spacing_mm = 22.0, .focal_length_mm = 0.0, .mirror_step_rad = 0.0};
  const HeadModel model(twoMirrors(false));
  for (const Vector2d& aim : {Vector2d(0, 0), Vector2d(150, -150), Vector2d(-37, 120)}) {
    const auto p = model.landing_W_mm(nominal.angles_rad(aim), HeadVector::Zero());
    ASSERT_TRUE(p);
    EXPECT_LT((*p - aim).norm(), 1e-10);
  }
}

// The twin's trace is independent of this one; for departures with the same meaning they must agree.
TEST(HeadModel, AgreesWithTheTwinWhereBothMeanTheSame) {
  for (const HeadDesign& design : designs()) {
    HeadVector d = departed(design, 7);
    const auto at = [&](HeadParameter p) -> double& { return d[static_cast<Eigen::Index>(indexOf(p))]; };
    for (const HeadParameter other :
         {HeadParameter::kXAxisTiltA, HeadParameter::kXAxisTiltB, HeadParameter::kXFaceTilt,
          HeadParameter::kYAxisTiltA, HeadParameter::kYAxisTiltB, HeadParameter::kYFaceTilt,
          HeadParameter::kBeamOffsetA, HeadParameter::kBeamOffsetB, HeadParameter::kBeamTiltA,
          HeadParameter::kBeamTiltB, HeadParameter::kPlaneShiftX, HeadParameter::kPlaneShiftY,
          HeadParameter::kPlaneTurn, HeadParameter::kLensTiltX, HeadParameter::kLensTiltY})
      at(other) = 0.0;
    twin::ScanHeadDescription head;
    head.throw_mm = design.throw_mm + at(HeadParameter::kThrow);
    head.mirror_spacing_mm = design.mirror_spacing_mm + at(HeadParameter::kMirrorSpacing);
    head.y_mirror_first = design.y_mirror_first;
    head.x = {
        {0, 0}, at(HeadParameter::kXSurface), at(HeadParameter::kXZero), 1 + at(HeadParameter::kXScale)};
    head.y = {
        {0, 0}, at(HeadParameter::kYSurface), at(HeadParameter::kYZero), 1 + at(HeadParameter::kYScale)};
    if (design.lens) {
      twin::LensDescription lens;
      lens.focal_length_mm = design.lens->focal_length_mm * (1 + at(HeadParameter::kFocalLength));
      lens.k1 = design.lens->k1_1_rad2 + at(HeadParameter::kLensK1);
      lens.k2 = design.lens->k2_1_rad4 + at(HeadParameter::kLensK2);
      lens.decentre_mm = {at(HeadParameter::kLensDecentreX), at(HeadParameter::kLensDecentreY)};
      lens.incidence_ratio = design.lens->incidence_ratio + at(HeadParameter::kLensIncidence);
      head.lens = lens;
    }
    twin::SurfaceDescription board;
    board.height_mm = at(HeadParameter::kPlaneHeight);
    board.slope = {at(HeadParameter::kPlaneSlopeX), at(HeadParameter::kPlaneSlopeY)};
    const twin::ScanHead truth(head, {});
    const twin::Surface surface(board);
    const HeadModel model(design);
    for (const Vector2d& angles : {Vector2d(0, 0), Vector2d(0.2, -0.2), Vector2d(-0.05, 0.18)}) {
      const auto p = model.landing_W_mm(angles, d);
      const auto spot = truth.spotAt(angles, Vector2d::Zero(), surface, 0.0);
      ASSERT_TRUE(p && spot);
      EXPECT_LT((*p - spot->p_WQ_mm).norm(), 1e-9);
    }
  }
}

TEST(HeadModel, SlopesAreThoseOfDifferences) {
  for (const HeadDesign& design : designs()) {
    const HeadModel model(design);
    const HeadVector d = departed(design, 3);
    const Vector2d angles(0.11, -0.17);
    const auto by_departures = model.departureSlopesAt(angles, d);
    const auto by_angles = model.angleSlopesAt(angles, d);
    ASSERT_TRUE(by_departures && by_angles);
    for (int k = 0; k < kCount; ++k) {
      const double step = 1e-3 * HeadTolerances().sigmas(design)[k];
      HeadVector up = d, down = d;
      up[k] += step;
      down[k] -= step;
      const Vector2d slope =
          (*model.landing_W_mm(angles, up) - *model.landing_W_mm(angles, down)) / (2 * step);
      EXPECT_LT((slope - by_departures->by_departures.col(k)).norm(), 1e-6 * (1.0 + slope.norm()))
          << textOf(static_cast<HeadParameter>(k)).name;
      EXPECT_EQ(actsOn(static_cast<HeadParameter>(k), design), slope.norm() > 1e-9)
          << textOf(static_cast<HeadParameter>(k)).name;
    }
    for (int k = 0; k < 2; ++k) {
      const Vector2d step = 1e-6 * Vector2d::Unit(k);
      const Vector2d slope =
          (*model.landing_W_mm(angles + step, d) - *model.landing_W_mm(angles - step, d)) / 2e-6;
      EXPECT_LT((slope - by_angles->by_angles.col(k)).norm(), 1e-5);
    }
  }
}

// At a field angle of zero a root would have no derivative.
TEST(HeadModel, ALensIsSmoothOnItsAxis) {
  const HeadModel model(withLens());
  const auto slopes = model.angleSlopesAt(Vector2d::Zero(), HeadVector::Zero());
  ASSERT_TRUE(slopes);
  EXPECT_LT((slopes->by_angles - 860.0 * Eigen::Matrix2d::Identity()).norm(), 1e-9);
  EXPECT_TRUE(model.departureSlopesAt(Vector2d::Zero(), HeadVector::Zero())->by_departures.allFinite());
}

TEST(HeadModel, ABeamThatMissesLandsNowhere) {
  const HeadModel model(twoMirrors(false));
  EXPECT_FALSE(model.landing_W_mm({0.0, 0.79}, HeadVector::Zero()));
  EXPECT_FALSE(model.landing_W_mm({1.2, 0.0}, HeadVector::Zero()));
}

// The planner's formula is independent of this one; a table for one must not be run by another.
TEST(NominalHead, IsTheControllersFormula) {
  planner::MachineParameters machine;
  machine.mirror_step_rad = 7e-6;
  machine.throw_mm = 330.0;
  machine.mirror_spacing_mm = 22.0;
  machine.field_min_mm[0] = machine.field_min_mm[1] = -150.0;
  machine.field_max_mm[0] = machine.field_max_mm[1] = 150.0;
  NominalHead nominal{
      .throw_mm = 330.0, .mirror_spacing_mm = 22.0, .focal_length_mm = 0.0, .mirror_step_rad = 7e-6};
  for (const bool lens : {false, true}) {
    machine.head =
        lens ? planner::MachineParameters::Head::kFTheta : planner::MachineParameters::Head::kTwoMirror;
    machine.focal_length_mm = lens ? 430.0 : 0.0;
    nominal.focal_length_mm = machine.focal_length_mm;
    const planner::Axes axes(machine, {});
    for (const Vector2d& aim : {Vector2d(0, 0), Vector2d(150, -150), Vector2d(-37, 120)}) {
      EXPECT_LT((nominal.angles_rad(aim) / 7e-6 - axes.stepsAt(aim)).norm(), 1e-6);
      EXPECT_LT((nominal.aim_W_mm(nominal.angles_rad(aim)) - aim).norm(), 1e-10);
      EXPECT_LT((nominal.slopes_rad_mm(aim) / 7e-6 - axes.stepsPerMm(aim)).norm(), 1e-6);
    }
  }
}

TEST(NominalHead, TheNearestAimIsThatOfWholeSteps) {
  NominalHead nominal{
      .throw_mm = 330.0, .mirror_spacing_mm = 22.0, .focal_length_mm = 0.0, .mirror_step_rad = 1e-4};
  const Vector2d aim(77.7, -31.3);
  const Vector2d steps = nominal.angles_rad(nominal.nearestAim_W_mm(aim)) / 1e-4;
  EXPECT_LT((steps - steps.array().round().matrix()).norm(), 1e-9);
  EXPECT_LE((steps - nominal.angles_rad(aim) / 1e-4).cwiseAbs().maxCoeff(), 0.5 + 1e-9);
  EXPECT_NEAR(std::sqrt(nominal.roundingCovariance_mm2({0, 0})(1, 1)), 2 * 330 * 1e-4 / std::sqrt(12.0),
              1e-9);
  nominal.mirror_step_rad = 0.0;
  EXPECT_EQ(nominal.nearestAim_W_mm(aim), aim);
}

TEST(NominalHead, NamesEveryFault) {
  const auto faultsOf = [](const auto& what) -> std::string {
    try {
      check(what);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(faultsOf(NominalHead{
                .throw_mm = -1, .mirror_spacing_mm = -2, .focal_length_mm = 0, .mirror_step_rad = NAN}),
            "nominal.throw_mm must be above 0; nominal.mirror_spacing_mm must be 0 or more; "
            "nominal.mirror_step_rad must be 0 or more");
  HeadDesign design;
  design.lens = LensDesign{};
  EXPECT_EQ(faultsOf(design), "design.throw_mm must be above 0; design.lens.focal_length_mm must be above 0");
}

}  // namespace
}  // namespace kerfbench::calibrate
