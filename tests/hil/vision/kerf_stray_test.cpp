// SPDX-License-Identifier: Apache-2.0
// Cuts where the dieline has none are found, however thin or faint; print and hard light are none.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_stray.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using test::TwinCut;

TwinCut label() {
  TwinCut cut;
  for (const double x : {-10.0, 10.0}) cut.add(dieline::LineCurve{{x, -8.0}, {x, 8.0}});
  cut.add(dieline::LineCurve{{-6.0, 6.0}, {6.0, 6.0}}, dieline::Process::kCrease);
  cut.share_of[2] = 0.6;
  return cut;
}

void makeHard(TwinCut& cut, std::uint64_t seed) {
  cut.seed = cut.camera.board_seed = seed;
  cut.camera.bits = 10;
  cut.camera.light = {.vignette = 0.3, .gradient_x = 0.3, .gradient_y = -0.1};
  cut.camera.texture = {.grain_gray = 2.0, .grain_length_mm = 0.1};
  cut.camera.roughness.rms_mm = 0.005;
  cut.camera.hot.share = 2e-5;
  cut.board.scorch = {.fluence_j_mm2 = 0.15, .darkening = 0.3, .shift_mm = {0.1, 0.05}};
}

void print(TwinCut& cut) {
  cut.print.areas = {{.p_SA_mm = {0.0, 0.0}, .size_mm = {6.0, 3.0}, .angle_rad = 0.3},
                     {.p_SA_mm = {-10.0, 2.0}, .size_mm = {4.0, 1.0}, .angle_rad = 0.0, .ink = 0.6},
                     {.p_SA_mm = {4.0, -6.0}, .size_mm = {5.0, 0.3}, .angle_rad = -0.2},
                     {.p_SA_mm = {-4.0, -6.0}, .size_mm = {0.2, 4.0}, .angle_rad = 0.1, .ink = 0.3}};
}

StrayBox boxOf(std::size_t tile, double x0, double y0, double x1, double y1) {
  StrayBox box;
  box.tile = tile;
  box.box_S_mm = Eigen::AlignedBox2d(Eigen::Vector2d(x0, y0), Eigen::Vector2d(x1, y1));
  return box;
}

TEST(KerfStray, OneThatTwoTilesSeeIsOneAndTwoOfOneTileAreTwo) {
  // The cut has 6 mm, of which each of three tiles sees a part.
  const auto long_one = mergeStrays(
      {boxOf(0, 1.0, 5.0, 3.0, 5.3), boxOf(2, 4.4, 5.0, 7.0, 5.3), boxOf(1, 2.5, 5.0, 4.5, 5.3)}, 4, 0.5);
  ASSERT_EQ(long_one.size(), 1U);
  EXPECT_EQ(long_one[0].unit, 4);
  EXPECT_NEAR(long_one[0].extent_mm, 6.0, 1e-9);
  EXPECT_NEAR(long_one[0].p_S_mm.x(), 4.0, 1e-9);
  // Strays that one picture shows as separate are separate.
  EXPECT_EQ(mergeStrays({boxOf(0, 1.0, 5.0, 3.0, 5.3), boxOf(0, 1.0, 5.4, 3.0, 5.7)}, 0, 0.5).size(), 2U);
  EXPECT_EQ(mergeStrays({boxOf(0, 1.0, 5.0, 3.0, 5.3), boxOf(1, 1.0, 6.0, 3.0, 6.3)}, 0, 0.5).size(), 2U);
  EXPECT_EQ(mergeStrays({boxOf(0, 1.0, 5.0, 1.2, 5.3)}, 0, 0.5).size(), 0U) << "dust";
}

TEST(KerfStray, PrintAndHardLightAreNoCuts) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    TwinCut cut = label();
    makeHard(cut, seed);
    print(cut);
    const KerfScan scan = cut.scan();
    EXPECT_THAT(scan.problems, testing::IsEmpty());
    EXPECT_THAT(scan.strays, testing::IsEmpty()) << "seed " << seed;
  }
}

struct Grain {
  double gray;
  double length_mm;
};

TEST(KerfStray, GrainOfBrightBoardIsNoCutAndACutInItIsFound) {
  // Bright board has little contrast to an open kerf, so its grain is a larger share of it: at 30 % of the
  // light, 3 gray are 1.8 % of the contrast, and flocks that are 1.9 times as bright reach kStrayContrast.
  for (const Grain& grain : {Grain{3.0, 0.1}, Grain{3.0, 0.15}, Grain{3.0, 0.3}, Grain{5.0, 0.15}}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      TwinCut cut = label();
      cut.seed = cut.camera.board_seed = seed;
      cut.board.transmission = 0.3;
      cut.camera.texture = {.grain_gray = grain.gray, .grain_length_mm = grain.length_mm};
      const std::string name = fmt::format("{} gray of {} mm, seed {}", grain.gray, grain.length_mm, seed);
      EXPECT_THAT(cut.scan().strays, testing::IsEmpty()) << name;
      const Vector2d at(0.0, -3.5);
      cut.also = [&](twin::Sheet& sheet) {
        cut.burn(sheet, at - Vector2d(1.0, 0.2), at + Vector2d(1.0, 0.2), 0.8);
      };
      const KerfScan scan = cut.scan();
      ASSERT_EQ(scan.strays.size(), 1U) << name;
      EXPECT_LT((scan.strays[0].p_S_mm - at).norm(), 0.2) << name;
      EXPECT_NEAR(scan.strays[0].extent_mm, 2.0, 0.3) << name;
    }
  }
}

struct Faint {
  double share;      // Share of the fluence that cuts, in the middle.
  double length_mm;  // Length of the stray.
};

TEST(KerfStray, ThinAndFaintOnesAreFoundAnywhere) {
  // The light of the middle follows Beer's law: 0.45 of the depth transmits 73 gray where board transmits 28,
  // before the lens halves that. Strays burnt 0.35 deep are found in three of four cases.
  for (const Faint& faint : {Faint{1.5, 2.0}, Faint{1.02, 2.0}, Faint{0.6, 2.0}, Faint{0.45, 2.0}}) {
    int found = 0;
    int looked = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      for (const Vector2d& at :
           {Vector2d(0.0, -3.5), Vector2d(-14.0, 4.0), Vector2d(14.5, -5.0), Vector2d(2.0, 9.5)}) {
        TwinCut cut = label();
        makeHard(cut, seed);
        const Vector2d along(std::cos(0.3 * at.x()), std::sin(0.3 * at.x()));
        cut.also = [&](twin::Sheet& sheet) {
          cut.burn(sheet, at - 0.5 * faint.length_mm * along, at + 0.5 * faint.length_mm * along,
                   faint.share);
        };
        const KerfScan scan = cut.scan();
        ++looked;
        if (scan.strays.size() == 1 && (scan.strays[0].p_S_mm - at).norm() < 0.3 &&
            scan.strays[0].extent_mm > 0.5 * faint.length_mm) {
          ++found;
        }
      }
    }
    std::printf("  share %.2f, %.1f mm: %d of %d\n", faint.share, faint.length_mm, found, looked);
    EXPECT_EQ(found, looked) << faint.share;
  }
}

TEST(KerfStray, CutCreaseAndHalfCutAreToldByTheirLightInHardPicturesToo) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    TwinCut cut;
    makeHard(cut, seed);
    // The strays lie all over the uneven light.
    for (const double x : {-13.0, -5.0, 5.0, 13.0}) {
      cut.add(dieline::LineCurve{{x, -8.0}, {x + 1.0, 8.0}});
      cut.share_of[cut.add(dieline::LineCurve{{x + 2.0, -8.0}, {x + 3.0, 8.0}}, dieline::Process::kHalfCut)] =
          0.6;
    }
    const KerfScan scan = cut.scan();
    for (const EntityKerf& kerf : scan.entities) {
      const bool half =
          cut.dieline.entities[static_cast<std::size_t>(kerf.entity)].process == dieline::Process::kHalfCut;
      double low = 2.0, high = 0.0;
      for (const Caliper& c : kerf.calipers) {
        if (c.station_mm < 0.3 || c.station_mm > kerf.calipers.back().station_mm - 0.3) continue;
        EXPECT_TRUE(c.found);
        low = std::min(low, c.brightness);
        high = std::max(high, c.brightness);
      }
      if (seed == 1)
        std::printf("  E%d %s: brightness %.3f ... %.3f\n", kerf.entity, half ? "half cut" : "cut", low,
                    high);
      EXPECT_GT(low, half ? 0.1 : 0.8);
      EXPECT_LT(high, half ? 0.6 : 1.1);
    }
  }
}

TEST(KerfStray, ACutThroughPrintKeepsItsPlace) {
  TwinCut cut = label();
  print(cut);
  const KerfScan scan = cut.scan();
  test::Errors errors;
  errors.add(cut, scan);
  const test::Honesty h = errors.honesty();
  std::printf("  %zu calipers, some on print: bias %.2f um, sigma %.2f um, stated %.2f um\n", h.count,
              1e3 * h.bias_mm, 1e3 * h.sigma_mm, 1e3 * h.stated_mm);
  EXPECT_LT(std::abs(h.bias_mm), 0.001);
  EXPECT_LT(h.sigma_mm, 0.002);
  for (const Caliper& c : test::entityOf(scan, 0).calipers) {
    EXPECT_TRUE(c.found);
    EXPECT_GT(c.brightness, 0.8);
  }
}

}  // namespace
}  // namespace kerfbench::vision
