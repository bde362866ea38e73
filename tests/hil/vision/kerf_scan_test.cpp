// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/tile_source.h"
#include "hil/vision/kerf/kerf_measurement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/scan/sight_pairs.h"
#include "tests/hil/vision/kerf_workpiece.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

using test::kBoard;
using test::kCrease;
using test::kOpen;
using test::kWidthMm;
using test::line;
using test::Truth;
using test::Workpiece;

const EntityKerf& entityOf(const KerfScan& scan, int id, int unit = 0) {
  return *std::find_if(scan.entities.begin(), scan.entities.end(),
                       [&](const EntityKerf& e) { return e.entity == id && e.unit == unit; });
}

test::Statistics offsetsOf(const EntityKerf& kerf, double truth_mm) {
  std::vector<double> errors;
  for (const Caliper& c : kerf.calipers) {
    if (c.found && !c.near_joint) errors.push_back(c.offset_mm - truth_mm);
  }
  return test::statisticsOf(errors);
}

class KerfScanTest : public ::testing::Test {
 protected:
  /// Makes one scan of a good workpiece with known offsets, which is enough for many questions.
  static void SetUpTestSuite() {
    work_ = new Workpiece;
    int k = 0;
    for (const dieline::Entity& entity : work_->dieline.entities) {
      Truth t;
      t.offset_mm = 0.011 * ((k++ * 5) % 9 - 4);
      if (entity.process == dieline::Process::kCrease) t.gray = kCrease;
      if (entity.id == 2) {
        t.gap_begin_mm = 3.0;
        t.gap_end_mm = 5.0;
      }
      if (entity.id == 3) t.width_mm = 0.30;
      if (entity.id >= 9) t.offset_mm = 0.0;
      work_->truth[entity.id] = t;
    }
    work_->extra.push_back(line({23.0, 22.5}, {25.2, 23.0}));
    work_->extra.push_back(line({22.0, 2.0}, {22.1, 2.0}));  // dust
    tiles_ = new std::vector<camera::KerfTile>(work_->tiles());
    scan_ = new KerfScan(work_->scan(*tiles_));
  }
  static void TearDownTestSuite() {
    delete work_;
    delete tiles_;
    delete scan_;
  }
  static Workpiece* work_;
  static std::vector<camera::KerfTile>* tiles_;
  static KerfScan* scan_;
};
Workpiece* KerfScanTest::work_ = nullptr;
std::vector<camera::KerfTile>* KerfScanTest::tiles_ = nullptr;
KerfScan* KerfScanTest::scan_ = nullptr;

TEST_F(KerfScanTest, FindsTheSheetOnTheTable) {
  EXPECT_THAT(scan_->problems, ::testing::IsEmpty());
  EXPECT_LT(scan_->mark_residual_mm, 0.002);
  std::printf("  marks: residual %.2f um\n", 1e3 * scan_->mark_residual_mm);
  EXPECT_EQ(scan_->entities.size(), 13U);
}

TEST_F(KerfScanTest, OffsetsAreRightInAllDirections) {
  for (const int id : {0, 1, 2, 3, 4, 5, 6, 7, 9, 10}) {
    const Truth& t = work_->truth.at(id);
    const test::Statistics s = offsetsOf(entityOf(*scan_, id), t.offset_mm);
    std::printf("  E%d: offset %.1f um, bias %.2f um, sigma %.2f um\n", id, 1e3 * t.offset_mm, 1e3 * s.mean,
                1e3 * s.sigma);
    EXPECT_LT(std::abs(s.mean), 0.0015) << "E" << id;
    EXPECT_LT(s.sigma, t.gray < 100.0 ? 0.005 : 0.0025) << "E" << id;
  }
}

TEST_F(KerfScanTest, SaysWhereInTheCamerasFieldItLooked) {
  // The error of the camera's map needs the place in its own plane.
  std::size_t judged = 0;
  for (const EntityKerf& kerf : scan_->entities) {
    for (const Caliper& c : kerf.calipers) {
      if (!c.found) continue;
      ++judged;
      const Vector2d p_T = work_->tableFromSheet(c.p_S_mm);
      const bool in_a_tile = std::any_of(tiles_->begin(), tiles_->end(), [&](const camera::KerfTile& tile) {
        return (p_T - tile.p_TV_mm - c.p_V_mm).norm() < 0.01;
      });
      EXPECT_TRUE(in_a_tile) << "E" << kerf.entity << " at " << c.station_mm;
      EXPECT_TRUE(work_->camera.pixelIfSeen(c.p_V_mm, 0.6 / test::kPitchMm)) << c.p_V_mm.transpose();
    }
  }
  EXPECT_GT(judged, 300U);
}

TEST_F(KerfScanTest, WidthsAreRight) {
  for (const int id : {0, 1, 3, 5, 6}) {
    std::vector<double> widths;
    for (const Caliper& c : entityOf(*scan_, id).calipers) {
      if (c.found && !c.near_joint) widths.push_back(c.width_mm);
    }
    const test::Statistics s = test::statisticsOf(widths);
    std::printf("  E%d: width %.1f um, sigma %.1f um\n", id, 1e3 * s.mean, 1e3 * s.sigma);
    EXPECT_NEAR(s.mean, work_->truth.at(id).width_mm, 0.006) << "E" << id;
  }
}

TEST_F(KerfScanTest, AMissingPieceIsNotFound) {
  for (const Caliper& c : entityOf(*scan_, 2).calipers) {
    if (c.station_mm > 3.3 && c.station_mm < 4.7) {
      EXPECT_FALSE(c.found) << c.station_mm;
      EXPECT_TRUE(std::isnan(c.offset_mm));
      EXPECT_LT(c.brightness, 0.05);
    } else if (c.station_mm < 2.8 || c.station_mm > 5.2) {
      EXPECT_TRUE(c.found) << c.station_mm;
    }
  }
}

TEST_F(KerfScanTest, ACreaseIsHalfAsBright) {
  for (const Caliper& c : entityOf(*scan_, 6).calipers) {
    EXPECT_TRUE(c.found);
    EXPECT_NEAR(c.brightness, (kCrease - kBoard) / (kOpen - kBoard), 0.04);
  }
  for (const Caliper& c : entityOf(*scan_, 0).calipers) EXPECT_NEAR(c.brightness, 1.0, 0.05);
}

TEST_F(KerfScanTest, JointsAreCornersButNeitherNeighboursNorContinuations) {
  for (const Caliper& c : entityOf(*scan_, 7).calipers)
    EXPECT_EQ(c.near_joint, c.station_mm > 5.58) << c.station_mm;
  for (const int id : {0, 4, 5, 9, 10}) {
    for (const Caliper& c : entityOf(*scan_, id).calipers)
      EXPECT_FALSE(c.near_joint) << "E" << id << " " << c.u;
  }
  for (const int id : {11, 12}) {
    for (const Caliper& c : entityOf(*scan_, id).calipers) {
      EXPECT_FALSE(c.near_joint);  // There is enough board between them.
      EXPECT_TRUE(c.found);        // The nearest of the two kerfs is the entity's own.
      EXPECT_NEAR(c.offset_mm, 0.0, 0.02);
    }
  }
}

TEST_F(KerfScanTest, EndsOfARoundToolAreMeasured) {
  int seen = 0;
  for (const LineEnd& end : scan_->ends) {
    std::printf("  E%d %s: gap %.2f +- %.2f um\n", end.entity, end.at_start ? "start" : "end",
                1e3 * end.gap_mm, 1e3 * end.sigma_mm);
    EXPECT_TRUE(end.found);
    EXPECT_NEAR(end.gap_mm, 0.0, 3.0 * end.sigma_mm);
    ++seen;
  }
  // The entities are E0 ... E4, E6 both ends, the circle E5 once, E7 and E8, E9 and E10 one each.
  EXPECT_EQ(seen, 17);
}

TEST_F(KerfScanTest, AStrayIsFoundOnceAndDustIsNot) {
  ASSERT_EQ(scan_->strays.size(), 1U);
  EXPECT_LT((scan_->strays[0].p_S_mm - Vector2d(24.1, 22.75)).norm(), 0.1);
  EXPECT_NEAR(scan_->strays[0].extent_mm, 2.2 + kWidthMm, 0.15);
}

TEST_F(KerfScanTest, PatchesShowTheWorstPlaces) {
  ASSERT_EQ(scan_->patches.size(), 6U);
  double before = std::numeric_limits<double>::infinity();
  for (const KerfPatch& patch : scan_->patches) {
    double worst = 0.0;
    for (const Caliper& c : entityOf(*scan_, patch.entity).calipers) {
      if (c.found && !c.near_joint) worst = std::max(worst, std::abs(c.offset_mm));
    }
    EXPECT_LE(worst, before);
    before = worst;
    const Vector2d pixel = patch.pixel_from_S * patch.p_S_mm;
    ASSERT_GT(pixel.x(), 8.0);
    ASSERT_LT(pixel.x(), patch.image->width - 8.0);
    // No worst place lies so near to a tile's border that the picture could not be cut out around it.
    EXPECT_NEAR(pixel.x(), 0.5 * patch.image->width, 1.0);
    EXPECT_NEAR(pixel.y(), 0.5 * patch.image->height, 1.0);
    // The kerf itself lies within half its width and its offset.
    int brightest = 0;
    for (int r = -5; r <= 5; ++r) {
      for (int c = -5; c <= 5; ++c) {
        brightest = std::max<int>(
            brightest, patch.image->at(static_cast<int>(pixel.x()) + c, static_cast<int>(pixel.y()) + r));
      }
    }
    EXPECT_GT(brightest, 70);
  }
}

TEST_F(KerfScanTest, IsTheSameAtAnyNumberOfThreads) {
  Workpiece other = *work_;
  other.options.threads = 2;
  const KerfScan scan = other.scan(*tiles_);
  ASSERT_EQ(scan.entities.size(), scan_->entities.size());
  for (std::size_t e = 0; e < scan.entities.size(); ++e) {
    ASSERT_EQ(scan.entities[e].calipers.size(), scan_->entities[e].calipers.size());
    for (std::size_t i = 0; i < scan.entities[e].calipers.size(); ++i) {
      const Caliper& a = scan.entities[e].calipers[i];
      const Caliper& b = scan_->entities[e].calipers[i];
      EXPECT_EQ(a.found, b.found);
      if (a.found && b.found) {
        EXPECT_EQ(a.offset_mm, b.offset_mm);
        EXPECT_EQ(a.sigma_mm, b.sigma_mm);
      }
    }
  }
  EXPECT_EQ(scan.strays.size(), scan_->strays.size());
  EXPECT_EQ(scan.mark_residual_mm, scan_->mark_residual_mm);
}

TEST_F(KerfScanTest, ReportsItsSpeed) {
  const std::clock_t begin = std::clock();
  const KerfScan scan = work_->scan(*tiles_);
  const double ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::size_t calipers = 0;
  for (const EntityKerf& e : scan.entities) calipers += e.calipers.size();
  std::printf("  %.1f ms of processor for 4 tiles of 0.63 Mpx and %zu calipers\n", ms, calipers);
}

TEST_F(KerfScanTest, MissingTilesAreAProblem) {
  std::vector<camera::KerfTile> some(tiles_->begin(), tiles_->begin() + 3);
  const KerfScan scan = work_->scan(some);
  EXPECT_THAT(scan.problems, ::testing::Contains(::testing::HasSubstr("lie outside the tiles")));
  // A caliper that the border of a picture cuts off is outside, too.
  for (const EntityKerf& kerf : scan.entities) {
    for (const Caliper& c : kerf.calipers) {
      if (!c.found) continue;
      EXPECT_TRUE(work_->camera.pixelIfSeen(c.p_V_mm, 0.6 / test::kPitchMm))
          << "E" << kerf.entity << " at " << c.station_mm;
    }
  }
  EXPECT_NEAR(offsetsOf(entityOf(scan, 0), work_->truth.at(0).offset_mm).mean, 0.0, 0.002);
}

TEST_F(KerfScanTest, MarksThatLieOtherwiseThanPrintedAreTold) {
  // The pose has a mark that lies 60 um off: no pose fits better than a quarter of that.
  Workpiece other = *work_;
  other.print.marks[2].p_SM_mm.x() += 0.06;
  const KerfScan off = other.scan(*tiles_);
  EXPECT_GT(off.mark_residual_mm, 0.010);
  ASSERT_EQ(off.units.size(), 1U);
  EXPECT_EQ(off.units[0].residual_mm, off.mark_residual_mm);
}

TEST_F(KerfScanTest, WhereMostMarksAreMissingItSaysSo) {
  // The layout has five more marks, in view of the tiles, than were printed.
  Workpiece other = *work_;
  for (const double x : {10.0, 14.0, 18.0, 22.0, 26.0}) other.print.marks.push_back({{x, 14.0}, 3.0});
  EXPECT_THAT(other.scan(*tiles_).problems, ::testing::Contains(::testing::HasSubstr("only 4 of 9")));
}

TEST_F(KerfScanTest, EachMarkThatTwoTilesShowTellsTheirShiftAlongBothAxes) {
  // The second tile stands 10 mm further on, and 0.02 mm off what the table says; a third shows another mark.
  std::vector<TileView> tiles(3);
  const auto show = [&](std::size_t tile, const Vector2d& p_TV, const Vector2d& p_TM) {
    tiles[tile].tile.p_TV_mm = p_TV;
    tiles[tile].centre_T_mm = p_TV;
    tiles[tile].half_diagonal_mm = 10.0;
    tiles[tile].marks.push_back({.p_mm = p_TM - p_TV, .sigma_mm = 0.001});
  };
  show(0, {0, 0}, {6, 1});
  show(1, {10, 0}, {6.02, 1.01});
  show(2, {20, 0}, {25, 3});
  const TileIndex index(tiles, work_->camera);
  const PlaneMotion X_TS;
  const auto pairs = sightPairs({}, {tiles, index, X_TS, work_->camera, work_->options});
  ASSERT_EQ(pairs.size(), 2U);
  for (const SightPair& pair : pairs) {
    EXPECT_EQ(pair.tile, 0U);
    EXPECT_EQ(pair.other, 1U);
    EXPECT_NEAR(pair.apart_mm, pair.normal.x() > 0.5 ? 0.02 : 0.01, 1e-9);
    EXPECT_NEAR(pair.sigma_mm, 0.001 * std::sqrt(2.0), 1e-9);
  }
}

TEST_F(KerfScanTest, PicturesThatContradictEachOtherAreNamed) {
  const auto contradict = ::testing::Contains(::testing::HasSubstr("pictures contradict each other"));
  EXPECT_THAT(scan_->problems, ::testing::Not(contradict));
  const GrayImage& good = tiles_->front().image;
  for (const int from : {0, good.width / 2}) {
    std::vector<camera::KerfTile> painted = *tiles_;
    std::vector<camera::KerfTile> moved = *tiles_;
    for (int row = 0; row + 1 < good.height; ++row) {
      for (int column = from; column < from + good.width / 2; ++column) {
        painted[0].image.at(column, row) = static_cast<std::uint8_t>(kBoard);
        // A pixel aside, 0.03 mm: the kerf is there, but elsewhere.
        moved[0].image.at(column, row) = good.at(column, row + 1);
      }
    }
    EXPECT_THAT(work_->scan(painted).problems, contradict) << "from column " << from;
    EXPECT_THAT(work_->scan(moved).problems, contradict) << "from column " << from;
  }
}

TEST(KerfScan, OneCaliperOutsideOfThePicturesIsTold) {
  Workpiece work;
  work.dieline.entities.resize(1);
  work.dieline.entities[0].curve = line({38.0, 13.0}, {44.5, 13.0});
  work.options.station_pitch_mm = 3.3;
  EXPECT_THAT(work.scan(work.tiles()).problems,
              ::testing::Contains(::testing::HasSubstr("1 of 3 calipers of E0 lie outside the tiles")));
}

TEST(KerfScan, ALineOfTwoStationsIsNoStrayCut) {
  Workpiece work;
  work.dieline.entities.resize(1);
  work.dieline.entities[0].curve = line({18.0, 13.0}, {20.0, 13.0});
  work.options.station_pitch_mm = 3.0;
  const KerfScan scan = work.scan(work.tiles());
  ASSERT_EQ(scan.entities.at(0).calipers.size(), 2U);
  EXPECT_TRUE(scan.strays.empty());
}

TEST_F(KerfScanTest, TwoMarksTellWhereTheSheetLies) {
  Workpiece other = *work_;
  other.print.marks = {work_->print.marks.front(), work_->print.marks.back()};
  const KerfScan scan = other.scan(*tiles_);
  ASSERT_EQ(scan.units.size(), scan_->units.size());
  EXPECT_EQ(scan.units.front().marks, 2);
  EXPECT_LT((scan.units.front().p_TS_mm - scan_->units.front().p_TS_mm).norm(), 0.01);
}

TEST_F(KerfScanTest, OfFewPicturesTheWorstAreKept) {
  Workpiece other = *work_;
  other.options.patches = 2;
  const KerfScan few = other.scan(*tiles_);
  ASSERT_EQ(few.patches.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(few.patches[i].entity, scan_->patches[i].entity);
  other.options.patches = 0;
  EXPECT_TRUE(other.scan(*tiles_).patches.empty());
  const auto worstOf = [&](const EntityKerf& kerf) {
    double worst = 0.0;
    for (const Caliper& c : kerf.calipers) {
      if (c.found && !c.near_joint) worst = std::max(worst, std::abs(c.offset_mm));
    }
    return worst;
  };
  const double second = worstOf(entityOf(*scan_, few.patches[1].entity));
  EXPECT_LE(std::count_if(scan_->entities.begin(), scan_->entities.end(),
                          [&](const EntityKerf& kerf) { return worstOf(kerf) > second; }),
            1);
}

TEST_F(KerfScanTest, TheLastUnitWithoutTilesIsAProblemToo) {
  Workpiece two = *work_;
  two.print.units = 2;
  const KerfScan scan = two.scan(*tiles_);
  EXPECT_THAT(scan.problems, ::testing::ElementsAre(::testing::HasSubstr("unit 1: no tile")));
  EXPECT_EQ(scan.entities.size(), 2U * 13U);
}

TEST_F(KerfScanTest, TilesOfAUnitThatTheWebDoesNotHaveAreAProblem) {
  std::vector<camera::KerfTile> tiles = *tiles_;
  for (const camera::KerfTile& tile : *tiles_) tiles.push_back({tile.image, tile.p_TV_mm, 1});
  const KerfScan scan = work_->scan(tiles);
  EXPECT_THAT(scan.problems, ::testing::ElementsAre(::testing::HasSubstr("belong to no unit")));
  EXPECT_EQ(scan.entities.size(), 13U);
}

TEST_F(KerfScanTest, UnitsWithoutTilesOrMarksAreAProblem) {
  Workpiece two = *work_;
  two.print.units = 3;
  std::vector<camera::KerfTile> tiles = *tiles_;
  tiles.push_back({GrayImage(900, 700, 28), {0, 0}, 2});
  const KerfScan scan = two.scan(tiles);
  EXPECT_THAT(scan.problems, ::testing::Contains(::testing::HasSubstr("unit 1: no tile")));
  EXPECT_THAT(scan.problems, ::testing::Contains(::testing::HasSubstr("unit 2: no registration mark")));
  EXPECT_EQ(scan.entities.size(), 3U * 13U);
  EXPECT_TRUE(entityOf(scan, 0, 0).calipers[10].found);
  EXPECT_FALSE(entityOf(scan, 0, 1).calipers[10].found);
  EXPECT_FALSE(entityOf(scan, 0, 2).calipers[10].found);
}

TEST(KerfScan, ACutThatIsNotThereIsNotFoundAndTheRestIs) {
  Workpiece work;
  work.truth[1] = Truth{0.0, kWidthMm, kOpen, false};
  work.shift_mm = {-1.0, 1.0};
  work.angle_rad = -0.0087;
  work.print.marks.pop_back();
  work.print.marks.push_back({{20.0, 1.5}, 3.0});  // runs over the edge of a tile
  const KerfScan scan = work.scan(work.tiles());
  EXPECT_THAT(scan.problems, ::testing::IsEmpty());
  for (const Caliper& c : entityOf(scan, 1).calipers) EXPECT_FALSE(c.found);
  for (const Caliper& c : entityOf(scan, 3).calipers) EXPECT_TRUE(c.found);
  EXPECT_LT(std::abs(offsetsOf(entityOf(scan, 3), 0.0).mean), 0.002);
  EXPECT_THAT(scan.strays, ::testing::IsEmpty());
}

TEST(KerfScan, RefusesSenselessOptions) {
  const auto refuses = [](double KerfScanOptions::*option, double value) {
    Workpiece work;
    work.options.*option = value;
    EXPECT_THROW(static_cast<void>(work.scan({})), std::invalid_argument) << value;
  };
  using Options = KerfScanOptions;
  for (const auto option : {&Options::station_pitch_mm, &Options::reach_mm, &Options::open_gray})
    refuses(option, 0.0);
  for (const auto option : {&Options::beam_radius_mm, &Options::board_thickness_mm, &Options::table_sigma_mm,
                            &Options::table_scale_sigma, &Options::scale_sigma, &Options::open_gray_sigma,
                            &Options::print_sigma_mm})
    refuses(option, -1e-9);
}

TEST_F(KerfScanTest, CreasesDoNotTellHowWideCutsAre) {
  // Scorch dims creases.
  Workpiece whole = *work_;
  whole.options.beam_radius_mm = 0.11;
  const KerfScan with_creases = whole.scan(*tiles_);
  Workpiece without = whole;
  for (dieline::Entity& entity : without.dieline.entities)
    if (entity.process == dieline::Process::kCrease) entity.process = dieline::Process::kIgnore;
  const KerfScan scan = without.scan(*tiles_);
  for (const int id : {0, 1, 3, 5}) {
    const EntityKerf& with = entityOf(with_creases, id);
    const EntityKerf& alone = entityOf(scan, id);
    EXPECT_EQ(with.widening_mm, alone.widening_mm) << "E" << id;
    EXPECT_EQ(with.widening_sigma_mm, alone.widening_sigma_mm) << "E" << id;
    ASSERT_EQ(with.calipers.size(), alone.calipers.size());
    const std::size_t middle = with.calipers.size() / 2;
    EXPECT_EQ(with.calipers[middle].width_mm, alone.calipers[middle].width_mm) << "E" << id;
  }
}

TEST(KerfScan, ASheetMayLieTurnedByThirtyMilliradians) {
  Workpiece work;
  work.dieline.entities.resize(1);
  work.angle_rad = 0.029;
  EXPECT_EQ(work.scan(work.tiles()).units.size(), 1U);
  work.angle_rad = 0.034;
  const KerfScan scan = work.scan(work.tiles());
  EXPECT_TRUE(scan.units.empty());
  EXPECT_THAT(scan.problems, ::testing::Not(::testing::IsEmpty()));
}

}  // namespace
}  // namespace kerfbench::vision
