// SPDX-License-Identifier: Apache-2.0
// Common errors of readings, and their effect on widths, corners, ends and circles.
#include "hil/inspect/deviation/error_model.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

using Eigen::Vector2d;

ReadingLine lineOf(const ErrorModel& model, const SyntheticRun& run, int unit, int entity) {
  const std::vector<vision::EntityKerf>& kerfs = run.evidence.kerf.entities;
  const auto at = std::ranges::find_if(
      kerfs, [&](const vision::EntityKerf& kerf) { return kerf.unit == unit && kerf.entity == entity; });
  return model.line(static_cast<std::size_t>(at - kerfs.begin()));
}

TEST(ModeField, ShiftsPointsAsTheCalibrationDoes) {
  const SyntheticRun run;
  const vision::CameraCalibration& camera = *run.evidence.kerf_calibration;
  const ModeField field(camera);
  ASSERT_EQ(field.modes(), 3);
  for (const Vector2d& p_mm : {Vector2d(-31, 12), Vector2d(44, -7), Vector2d(3, 55)}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector2d shift_mm = camera.mapError(k, p_mm);
      EXPECT_LT((field.at(static_cast<Eigen::Index>(k), p_mm) - shift_mm).norm(), 0.02 * shift_mm.norm())
          << "mode " << k << " at " << p_mm.transpose();
    }
  }
}

TEST(ModeField, HasTheCalibrationsOwnShiftsAtTheCornersOfItsArea) {
  const SyntheticRun run;
  vision::CameraCalibration camera = *run.evidence.kerf_calibration;
  for (const Eigen::Index parameter : {0, 1, 4}) {  // Both focal lengths, and how the lens distorts.
    auto& mode = camera.error_modes.at(parameter == 4 ? 2U : static_cast<std::size_t>(parameter));
    mode.setZero();
    mode[parameter] = parameter == 4 ? 0.01 : 1.0;
  }
  const ModeField field(camera);
  using Corner = Eigen::AlignedBox2d::CornerType;
  for (const Corner which : {Corner::BottomLeft, Corner::BottomRight, Corner::TopLeft, Corner::TopRight}) {
    const Vector2d p_mm = camera.area_mm.corner(which);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT((field.at(static_cast<Eigen::Index>(k), p_mm) - camera.mapError(k, p_mm)).norm(), 1e-12)
          << "mode " << k << " at " << p_mm.transpose();
    }
  }
}

TEST(NeighbourCorrelation, IsOfTheNoiseAndNotOfTheBendThatItLiesOn) {
  const CounterRandom random(7, 0);
  std::vector<double> noise;
  std::vector<double> bent;
  for (std::size_t i = 0; i < 200; ++i) {
    const double s = 0.1 * static_cast<double>(i);
    noise.push_back(0.5 * (random.normal(i) + random.normal(i + 1)));
    bent.push_back(noise.back() + 40.0 - 7.0 * s + 0.3 * s * s);
  }
  EXPECT_GT(neighbourCorrelation({noise}), 0.2);
  EXPECT_NEAR(neighbourCorrelation({bent}), neighbourCorrelation({noise}), 1e-6);
}

TEST(ErrorModel, ReadingsBesideAGapDoNotKnowOfEachOther) {
  const SyntheticRun run;
  const ErrorModel model = errorModelOf(run.evidence);
  // The line has 35 mm: nine teeth of 3 mm with bridges of 1 mm between them.
  const ReadingLine& teeth = lineOf(model, run, 0, kPerforationLine);
  EXPECT_EQ(teeth.segment.size(), 9U + 1U);
  for (std::size_t s = 0; s + 1 < teeth.segment.size(); ++s) {
    for (std::size_t i = teeth.segment[s] + 1; i < teeth.segment[s + 1]; ++i)
      EXPECT_EQ(teeth.caliper[i], teeth.caliper[i - 1] + 1);
  }
}

/// Compares offsets of a line by a shift and a turn of a unit: rows of `shared`, and the geometry of moving
/// the nominal points.
TEST(ErrorModel, PoseErrorsMoveReadingsAsTheSheetMoves) {
  SyntheticRun run;
  run.evidence.kerf.units[0].covariance = Eigen::Vector3d(4e-6, 0.0, 0.0).asDiagonal();
  run.evidence.kerf.units[1].covariance = Eigen::Vector3d(0.0, 0.0, 1e-8).asDiagonal();
  const ErrorModel model = errorModelOf(run.evidence);
  for (const int entity : {kBottom, kRight, kHole}) {
    const dieline::Curve& curve = run.dieline.entities[static_cast<std::size_t>(entity)].curve;
    for (const int unit : {0, 1}) {
      const ReadingLine& line = lineOf(model, run, unit, entity);
      for (std::size_t i = 0; i < line.size(); i += 17) {
        const vision::Caliper& c = run.kerf(unit, entity).calipers[line.caliper[i]];
        // The pose with an error of one standard deviation moves the point, seen across the line.
        const Vector2d moved = unit == 0 ? Vector2d(c.p_S_mm + Vector2d(2e-3, 0.0))
                                         : Vector2d(Eigen::Rotation2Dd(1e-4) * c.p_S_mm);
        const Vector2d tangent = dieline::tangentAt(curve, c.u);
        const double across_mm = tangent.x() * (moved - c.p_S_mm).y() - tangent.y() * (moved - c.p_S_mm).x();
        const Eigen::RowVectorXd shared = line.shared.row(static_cast<Eigen::Index>(i));
        EXPECT_NEAR(shared.segment<ReadingLine::kPose>(ReadingLine::kLine).norm(), std::abs(across_mm), 1e-6);
      }
    }
  }
}

/// Two tiles of the unit, parted at a station of its right side.
TEST(ErrorModel, TheTableMovesAllReadingsInATileAlike) {
  SyntheticRun run;
  run.evidence.kerf.table_sigma_mm = 0.003;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (vision::Caliper& c : kerf.calipers) c.tile = c.p_S_mm.y() < 20.0 ? 0 : 1;
  }
  const ErrorModel model = errorModelOf(run.evidence);
  const auto units = static_cast<Eigen::Index>(run.evidence.kerf.units.size());
  EXPECT_EQ(model.tiles, 2 * 2 * units);
  const auto ofTiles = [&](const ReadingLine& line, std::size_t reading) {
    Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(model.tiles);
    for (std::size_t k = 0; k < line.tiles.size(); ++k) {
      all[line.tiles[k]] =
          line.shared(static_cast<Eigen::Index>(reading), ReadingLine::kOwn + static_cast<Eigen::Index>(k));
    }
    return all;
  };
  const ReadingLine& line = lineOf(model, run, 0, kRight);
  EXPECT_EQ(line.tileColumns(), 2 * 2) << "of the tiles that it lies in alone";
  const Eigen::RowVectorXd first = ofTiles(line, 0);
  const Eigen::RowVectorXd last = ofTiles(line, line.size() - 1);
  EXPECT_NEAR(first.norm(), 0.003, 1e-9);
  EXPECT_EQ(first.dot(last), 0.0);
  std::size_t in_first = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::RowVectorXd here = ofTiles(line, i);
    EXPECT_LT(std::min((here - first).norm(), (here - last).norm()), 1e-12);
    in_first += (here - first).norm() < 1e-12 ? 1 : 0;
  }
  EXPECT_GT(in_first, line.size() / 4);
  EXPECT_LT(in_first, line.size() - line.size() / 4);
  // The other unit lies elsewhere on the table, and was seen in other tiles.
  EXPECT_EQ(first.dot(ofTiles(lineOf(model, run, 1, kRight), 0)), 0.0);
  // A line at right angles to it moves by the other axis of the same tile.
  const ReadingLine& bottom = lineOf(model, run, 0, kBottom);
  EXPECT_NEAR(first.dot(ofTiles(bottom, 0)), 0.0, 1e-9);
}

TEST(ErrorModel, TheTablesScaleMovesReadingsAwayFromTheMarks) {
  SyntheticRun run;
  run.evidence.kerf.scale_sigma = 1e-4;
  const Vector2d centre_mm(30.0, 20.0);
  for (vision::UnitPose& pose : run.evidence.kerf.units) pose.marks_centre_S_mm = centre_mm;
  const ErrorModel model = errorModelOf(run.evidence);
  const auto shiftOf = [&](int entity, std::size_t reading) {
    const ReadingLine& line = lineOf(model, run, 0, entity);
    const vision::Caliper& c = run.kerf(0, entity).calipers[line.caliper[reading]];
    const Eigen::Index column = line.shared.cols() - ReadingLine::kSight - ReadingLine::kScale;
    const Vector2d tangent =
        dieline::tangentAt(run.dieline.entities[static_cast<std::size_t>(entity)].curve, c.u);
    const double wanted_mm = 1e-4 * Vector2d(-tangent.y(), tangent.x()).dot(c.p_S_mm - centre_mm);
    EXPECT_NEAR(line.shared(static_cast<Eigen::Index>(reading), column), wanted_mm, 1e-12) << entity;
    return std::abs(wanted_mm);
  };
  EXPECT_GT(shiftOf(kRight, 3), 0.002) << "a side far from the marks' middle moves by its distance";
  EXPECT_NEAR(shiftOf(kRight, 0), shiftOf(kRight, 9), 1e-9) << "all along";
  EXPECT_GT(shiftOf(kBottom, 3), 0.001);
}

TEST(ErrorModel, TheCamerasErrorsHaveColumnsOfTheirOwnBehindTheTiles) {
  SyntheticRun run;
  const auto rowOf = [](const ReadingLine& line) { return Eigen::RowVectorXd(line.shared.row(5)); };
  const Eigen::RowVectorXd without = rowOf(lineOf(errorModelOf(run.evidence), run, 0, kRight));
  run.evidence.kerf.table_sigma_mm = 0.003;
  const ErrorModel model = errorModelOf(run.evidence);
  const Eigen::RowVectorXd with = rowOf(lineOf(model, run, 0, kRight));
  ASSERT_EQ(with.size(), without.size() + lineOf(model, run, 0, kRight).tileColumns());
  const Eigen::Index behind = without.size() - ReadingLine::kOwn;
  EXPECT_EQ((with.tail(behind) - without.tail(behind)).norm(), 0.0);
  EXPECT_EQ((with.head(ReadingLine::kOwn) - without.head(ReadingLine::kOwn)).norm(), 0.0);
  EXPECT_GT(without.segment(ReadingLine::kOwn, behind - ReadingLine::kSight).norm(), 0.0);
}

TEST(ErrorModel, SightAndTiltMoveReadingsByGeometry) {
  SyntheticRun run;
  vision::CameraCalibration& camera = *run.evidence.kerf_calibration;
  camera.X_CP.translation() = Eigen::Vector3d(0.0, 0.0, 300.0);
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    kerf.depth_mm = 0.25;
    kerf.depth_sigma_mm = 0.05;
    for (vision::Caliper& c : kerf.calipers) c.p_V_mm = {24.0, -12.0};
  }
  const auto row = [&](int entity) {
    return Eigen::RowVectorXd(lineOf(errorModelOf(run.evidence), run, 0, entity).shared.row(5));
  };
  const auto angleOf = [&] { return Eigen::Rotation2Dd(run.evidence.kerf.units[0].angle_rad); };
  const dieline::Curve& curve = run.dieline.entities[static_cast<std::size_t>(kRight)].curve;
  const Vector2d tangent = angleOf() * dieline::tangentAt(curve, 0.3);
  const Vector2d normal(-tangent.y(), tangent.x());
  EXPECT_NEAR(row(kRight).tail<ReadingLine::kSight>()[0], 0.05 * normal.dot(Vector2d(24.0, -12.0)) / 300.0,
              1e-9);
  // A telecentric lens has no slope, but may not be square by an angle of unknown direction.
  camera.telecentric_mm = 300.0;
  camera.square_within_rad = 0.008;
  const Eigen::Vector3d tilted = row(kRight).tail<ReadingLine::kSight>();
  EXPECT_EQ(tilted[0], 0.0);
  EXPECT_NEAR(tilted.norm(), 0.5 * (0.25 + 0.05) * 0.008, 1e-9);
}

TEST(KerfWidth, IsNotMovedByFewWildReadings) {
  SyntheticRun run;
  const auto widthOf = [&](int unit, int entity) {
    for (const EntityResult& e : run.inspected().entities) {
      if (e.unit == unit && e.entity == entity) return e.width_mm;
    }
    return std::nan("");
  };
  const double before_mm = widthOf(0, kTop);
  auto& calipers = run.kerf(0, kTop).calipers;
  for (std::size_t i = 20; i < 200; i += 30) calipers[i].width_mm = 1.1;
  EXPECT_NEAR(widthOf(0, kTop), before_mm, 2e-4);
}

TEST(KerfWidth, LeavesOutWhatLiesFiveScattersAndMoreFromTheMedian) {
  constexpr double kScatter_mm = 0.01 * 1.4826;
  const auto widthWith = [](double off_scatters) {
    SyntheticRun run;
    auto& calipers = run.kerf(0, kTop).calipers;
    for (std::size_t i = 0; i < calipers.size(); ++i)
      calipers[i].width_mm = 0.2 + 0.01 * (static_cast<double>(i % 3) - 1.0);
    for (std::size_t i = 20; i < 200; i += 30) calipers[i].width_mm = 0.2 + off_scatters * kScatter_mm;
    for (const EntityResult& e : run.inspected().entities) {
      if (e.unit == 0 && e.entity == kTop) return e.width_mm;
    }
    return std::nan("");
  };
  EXPECT_NEAR(widthWith(5.5), widthWith(50.0), 1e-9);
  EXPECT_GT(widthWith(3.0), widthWith(50.0) + 1e-4);
}

TEST(KerfWidth, KnowsOfTheLensOnlyWhereBlurWasTakenOff) {
  SyntheticRun run;
  const auto widths = [&] {
    for (const EntityResult& e : run.inspected().entities) {
      if (e.unit == 0 && e.entity == kTop) return e;
    }
    return EntityResult{};
  };
  const EntityResult sharp = widths();
  EXPECT_EQ(sharp.width_U_mm, sharp.width_own_U_mm);
  run.kerf(0, kTop).widening_mm = 0.02;
  run.kerf(0, kTop).widening_sigma_mm = 0.0015;
  const EntityResult blurred = widths();
  EXPECT_GT(blurred.width_own_U_mm, sharp.width_own_U_mm);
  // The uncertainty of the lens's blur counts for all kerfs alike.
  const double common_U_mm =
      std::sqrt(blurred.width_U_mm * blurred.width_U_mm - blurred.width_own_U_mm * blurred.width_own_U_mm);
  EXPECT_NEAR(common_U_mm, 2.0 * 0.0015, 1e-9);
}

TEST(KerfWidth, KnowsOfWallsWhereTheyAreSeenMoreAslantThanUsual) {
  // Walls that hide the same of each kerf hide no difference; of a kerf aside, they hide more.
  SyntheticRun run;
  const auto widthOf = [&](int entity) {
    const auto result = run.inspected();
    return *std::ranges::find_if(result.entities,
                                 [&](const EntityResult& e) { return e.unit == 0 && e.entity == entity; });
  };
  const double before_mm = widthOf(kTop).width_own_U_mm;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) kerf.walls_sigma_mm = 0.001;
  EXPECT_EQ(widthOf(kTop).width_own_U_mm, before_mm);
  run.kerf(0, kTop).walls_sigma_mm = 0.005;
  const double aside_mm = widthOf(kTop).width_own_U_mm;
  EXPECT_NEAR(std::sqrt(aside_mm * aside_mm - before_mm * before_mm), 2.0 * 0.004, 1e-9);
  // A crease is not compared with cuts.
  run.kerf(0, kTop).walls_sigma_mm = 0.001;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities)
    if (kerf.entity == kCreaseLine) kerf.walls_sigma_mm = 0.009;
  EXPECT_EQ(widthOf(kTop).width_own_U_mm, before_mm);
}

TEST(KerfWidth, IsLessCertainByTheShareOfItsBlurThatItsShapeTells) {
  // The standard deviation of what blur added is 3.2 % of it; 6 % where the kerf lets only part of the
  // light through.
  const auto added = [](int entity) {
    SyntheticRun run;
    const auto ownU = [&] {
      const auto result = run.inspected();
      return std::ranges::find_if(result.entities,
                                  [&](const EntityResult& e) { return e.unit == 0 && e.entity == entity; })
          ->width_own_U_mm;
    };
    const double sharp_mm = ownU();
    run.kerf(0, entity).widening_mm = 0.02;
    return std::sqrt(std::pow(ownU(), 2) - sharp_mm * sharp_mm);
  };
  EXPECT_NEAR(added(kTop), 2.0 * 0.032 * 0.02, 1e-6);
  EXPECT_NEAR(added(kCreaseLine), 2.0 * 0.06 * 0.02, 1e-6);
}

TEST(KerfWidth, NoiseThatNeighboursShareDoesNotAverageOut) {
  SyntheticRun run;
  const auto ownU = [&] {
    for (const EntityResult& e : run.inspected().entities) {
      if (e.unit == 0 && e.entity == kTop) return e.width_own_U_mm;
    }
    return 0.0;
  };
  const double independent_mm = ownU();
  // Offsets show how alike neighbours are: here each is the mean of four samples, twice as large.
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (std::size_t i = 0; i + 3 < kerf.calipers.size(); ++i) {
      double sum_mm = 0.0;
      for (std::size_t k = 0; k < 4; ++k) sum_mm += kerf.calipers[i + k].offset_mm;
      if (std::isfinite(sum_mm)) kerf.calipers[i].offset_mm = 0.5 * sum_mm;
    }
  }
  // The mean of neighbours with q = 0.75 is sqrt((1 + q) / (1 - q)) = 2.6 times less certain.
  EXPECT_GT(ownU(), 1.8 * independent_mm);
  EXPECT_LT(ownU(), 3.2 * independent_mm);
}

TEST(Circularity, OfAnArcThatIsNoWholeCircleIsNone) {
  SyntheticRun run;
  auto& arc = std::get<dieline::ArcCurve>(run.dieline.entities[kHole].curve);
  arc.sweep_rad *= 0.96;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities)
    if (kerf.entity == kHole) kerf.calipers.resize(96 * kerf.calipers.size() / 100);
  for (const EntityResult& e : run.inspected().entities)
    EXPECT_TRUE(std::isnan(e.circularity_mm)) << e.entity;
}

TEST(Circularity, OfAnOvalHoleIsTheRangeOfItsRadii) {
  SyntheticRun run;
  constexpr double kLobe_mm = 0.03;
  const auto circularityOf = [](const InspectionResult& result, int entity) {
    const auto& all = result.entities;
    return *std::find_if(all.begin(), all.end(), [&](const EntityResult& e) { return e.entity == entity; });
  };
  const EntityResult round = circularityOf(run.inspected(), kHole);
  EXPECT_LT(round.circularity_mm - round.circularity_U_mm, 0.001);
  for (vision::Caliper& c : run.kerf(0, kHole).calipers) {
    const double angle_rad = std::atan2(c.p_S_mm.y() - 20.0, c.p_S_mm.x() - 15.0);
    // The circle is off centre, too large and oval: only the last is a deviation of form.
    c.offset_mm += 0.01 + 0.02 * std::cos(angle_rad) + kLobe_mm * std::cos(2.0 * angle_rad);
  }
  const EntityResult oval = circularityOf(run.inspected(), kHole);
  EXPECT_NEAR(oval.circularity_mm, 2.0 * kLobe_mm, std::max(0.003, oval.circularity_U_mm));
  EXPECT_LT(oval.circularity_U_mm, 0.006);
  EXPECT_TRUE(std::isnan(circularityOf(run.inspected(), kTop).circularity_mm));
}

JointResult jointOf(const SyntheticRun& run, JointResult::Kind kind, bool at_start = false) {
  for (const JointResult& j : run.inspected().joints) {
    if (j.kind == kind && j.at_start == at_start) return j;
  }
  ADD_FAILURE() << "no " << jointName(kind);
  return {};
}

/// A corner, both ends of the crease and the closure of the hole.
SyntheticRun withJoints() {
  SyntheticRun run;
  run.evidence.kerf.corners.push_back({.unit = 0,
                                       .entity_in = kBottom,
                                       .entity_out = kRight,
                                       .p_S_mm = {60.0, 0.0},
                                       .turn_rad = 1.5708,
                                       .found = true,
                                       .rounding_mm = 0.02,
                                       .overshoot_mm = 0.0,
                                       .rounding_sigma_mm = 0.003,
                                       .overshoot_sigma_mm = 0.003,
                                       .deviation_sigma_mm = 0.003});
  for (const bool at_start : {true, false})
    run.evidence.kerf.ends.push_back({0, kCreaseLine, at_start, true, 0.04, 0.003});
  run.evidence.kerf.ends.push_back({0, kHole, true, true, 0.05, 0.003});
  return run;
}

TEST(Joints, HaveTheirPlaceAndTwiceTheirSigma) {
  SyntheticRun run = withJoints();
  run.evidence.kerf_calibration->map_u_mm = 0.0;
  for (vision::UnitPose& pose : run.evidence.kerf.units) pose.covariance.setZero();
  for (const auto kind : {JointResult::Kind::kRounding, JointResult::Kind::kOvershoot})
    EXPECT_NEAR(jointOf(run, kind).mm.U, 0.006, 1e-9);
  const JointResult start = jointOf(run, JointResult::Kind::kEndGap, true);
  EXPECT_NEAR(start.mm.U, 0.006, 1e-9);
  EXPECT_EQ(start.mm.value, 0.04);
  EXPECT_LT((start.p_S_mm - Vector2d(30, 2)).norm(), 1e-9);
  EXPECT_LT((jointOf(run, JointResult::Kind::kEndGap).p_S_mm - Vector2d(30, 38)).norm(), 1e-9);
}

TEST(Joints, KnowOfTheSheetsPlaceWhereTheyAreHeldAgainstTheDieline) {
  SyntheticRun run = withJoints();
  for (vision::UnitPose& pose : run.evidence.kerf.units)
    pose.covariance = Eigen::Vector3d(1e-4, 1e-4, 0.0).asDiagonal();
  const double U_mm = 2.0 * std::hypot(0.003, 0.01, run.evidence.kerf_calibration->map_u_mm);
  EXPECT_NEAR(jointOf(run, JointResult::Kind::kCorner).mm.U, U_mm, 1e-9);
  EXPECT_NEAR(jointOf(run, JointResult::Kind::kEndGap).mm.U, U_mm, 1e-9);
  // The joints are measured from the kerf's own legs, or its own begin, which all move with the sheet.
  for (const auto kind : {JointResult::Kind::kRounding, JointResult::Kind::kOvershoot})
    EXPECT_NEAR(jointOf(run, kind).mm.U, 0.006, 1e-9);
  EXPECT_NEAR(jointOf(run, JointResult::Kind::kClosure, true).mm.U, 0.006, 1e-9);
}

TEST(Joints, OfLinesThatTheDielineDoesNotHaveAreNone) {
  SyntheticRun run = withJoints();
  const std::size_t all = checks::measureJoints(run.evidence).size();
  vision::LineEnd end = run.evidence.kerf.ends.front();
  for (const int entity : {-1, static_cast<int>(run.dieline.entities.size())}) {
    end.entity = entity;
    run.evidence.kerf.ends.push_back(end);
  }
  EXPECT_EQ(checks::measureJoints(run.evidence).size(), all);
}

TEST(Joints, ThatWereNotFoundHaveNoValue) {
  SyntheticRun run = withJoints();
  run.evidence.kerf.corners[0].found = false;
  EXPECT_TRUE(std::isnan(jointOf(run, JointResult::Kind::kRounding).mm.value));
}

}  // namespace
}  // namespace kerfbench::inspect
