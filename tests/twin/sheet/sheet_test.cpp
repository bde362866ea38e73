// SPDX-License-Identifier: Apache-2.0
#include "twin/sheet/sheet.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr double kRadiusMm = 0.105;
constexpr double kPowerW = 30.0;
constexpr double kSpeedMmS = 300.0;
const double kLinePeak = std::sqrt(2.0 / std::numbers::pi) * kPowerW / kSpeedMmS / kRadiusMm;

Footprint spotAt(const Vector2d& p_S_mm) { return {p_S_mm, kRadiusMm, kRadiusMm}; }

/// Cuts a straight line in steps of 10 µs, as the twin does.
void cutLine(Sheet& sheet, const Vector2d& start_mm, const Vector2d& end_mm, double power_w = kPowerW) {
  const double step_s = 10e-6;
  const double length_mm = (end_mm - start_mm).norm();
  const int steps = static_cast<int>(std::lround(length_mm / (kSpeedMmS * step_s)));
  for (int i = 0; i < steps; ++i) {
    const Vector2d from = start_mm + (end_mm - start_mm) * i / steps;
    const Vector2d to = start_mm + (end_mm - start_mm) * (i + 1) / steps;
    sheet.burn(spotAt(from), spotAt(to), power_w * length_mm / kSpeedMmS / steps);
  }
}

class CutLine : public testing::TestWithParam<double> {
 protected:
  void SetUp() override {
    const double angle_rad = GetParam();
    along_ = {std::cos(angle_rad), std::sin(angle_rad)};
    across_ = {-along_.y(), along_.x()};
    cutLine(sheet_, middle_ - 3.0 * along_, middle_ + 3.0 * along_);
  }
  Sheet sheet_{BoardDescription{}};
  const Vector2d middle_{-7.0071, 3.0137};
  Vector2d along_;
  Vector2d across_;
};

TEST_P(CutLine, HasTheFluenceOfTheIntegralOverTheBeam) {
  for (double y = -0.25; y <= 0.25; y += 0.0073) {
    const double expected = kLinePeak * std::exp(-2.0 * y * y / (kRadiusMm * kRadiusMm));
    EXPECT_NEAR(sheet_.fluenceAt(middle_ + 0.31 * along_ + y * across_), expected, 2e-4 * kLinePeak) << y;
  }
}

TEST_P(CutLine, OpensAKerfOfTheRightWidthOnBothSides) {
  const double expected_mm =
      kRadiusMm * std::sqrt(std::log(kLinePeak / sheet_.board().cut_fluence_j_mm2) / 2.0);
  for (const double side : {1.0, -1.0}) {
    for (const double station_mm : {-1.0, 0.0, 0.127, 1.613}) {
      double open_mm = 0.0;
      double shut_mm = 0.3;
      while (shut_mm - open_mm > 1e-6) {
        const double mid_mm = 0.5 * (open_mm + shut_mm);
        const Vector2d p = middle_ + station_mm * along_ + side * mid_mm * across_;
        (sheet_.depthAt(p) >= 1.0 ? open_mm : shut_mm) = mid_mm;
      }
      EXPECT_NEAR(open_mm, expected_mm, 0.5e-3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Directions, CutLine, testing::Values(0.0, 0.3, 0.7853981634, 1.5707963268, 2.5));

TEST(Sheet, KeepsAllTheEnergyOfASpotAnywhereOnTheGrid) {
  for (const double radius_mm : {0.001, 0.02, 0.05, 0.105, 0.4}) {
    for (const double shift_mm : {0.0, 0.003, 0.0099, 0.0171}) {
      Sheet sheet{BoardDescription{}};
      const Footprint spot{{shift_mm - 0.64, 12.8 - shift_mm}, radius_mm, 1.3 * radius_mm};
      sheet.burn(spot, spot, 2e-3);
      EXPECT_NEAR(sheet.energyJ(), 2e-3, 2e-6);
    }
  }
}

TEST(Sheet, KeepsAllTheEnergyOfALongMoveWithAChangingFootprint) {
  Sheet sheet{BoardDescription{}};
  sheet.burn({{-40.0, 1.0}, 0.1, 0.12}, {{25.0, -9.0}, 0.15, 0.1}, 7.0);
  EXPECT_NEAR(sheet.energyJ(), 7.0, 7e-3);
}

TEST(Sheet, AnEllipticalSpotHasItsPeakAndItsTwoRadii) {
  Sheet sheet{BoardDescription{}};
  const Footprint spot{{1.0037, -2.0049}, 0.15, 0.08};
  sheet.burn(spot, spot, 1e-2);
  const double peak = 2e-2 / (std::numbers::pi * 0.15 * 0.08);
  EXPECT_NEAR(sheet.fluenceAt(spot.p_SQ_mm), peak, 1e-3 * peak);
  EXPECT_NEAR(sheet.fluenceAt(spot.p_SQ_mm + Vector2d(0.15, 0.0)), peak * std::exp(-2.0), 1e-3 * peak);
  EXPECT_NEAR(sheet.fluenceAt(spot.p_SQ_mm + Vector2d(0.0, 0.08)), peak * std::exp(-2.0), 1e-3 * peak);
}

TEST(Sheet, OneLongMoveBurnsTheSameAsManyShortOnes) {
  Sheet one{BoardDescription{}};
  Sheet many{BoardDescription{}};
  one.burn(spotAt({0.0, 0.0}), spotAt({3.0, 1.0}), 0.5);
  for (int i = 0; i < 1000; ++i) {
    many.burn(spotAt({3.0 * i / 1000, 1.0 * i / 1000}), spotAt({3.0 * (i + 1) / 1000, 1.0 * (i + 1) / 1000}),
              5e-4);
  }
  const double peak = many.fluenceAt({1.5, 0.5});
  for (double x = -0.3; x < 3.3; x += 0.0371) {
    EXPECT_NEAR(one.fluenceAt({x, x / 3.0 + 0.02}), many.fluenceAt({x, x / 3.0 + 0.02}), 2e-3 * peak) << x;
  }
}

TEST(Sheet, BurnsAddUpInAnyOrder) {
  Sheet first{BoardDescription{}};
  Sheet second{BoardDescription{}};
  Sheet both{BoardDescription{}};
  Sheet swapped{BoardDescription{}};
  cutLine(first, {-1.0, 0.0}, {1.0, 0.1});
  cutLine(second, {0.0, -1.0}, {0.1, 1.0});
  cutLine(both, {-1.0, 0.0}, {1.0, 0.1});
  cutLine(both, {0.0, -1.0}, {0.1, 1.0});
  cutLine(swapped, {0.0, -1.0}, {0.1, 1.0});
  cutLine(swapped, {-1.0, 0.0}, {1.0, 0.1});
  for (double t = -0.9; t < 0.9; t += 0.0313) {
    for (const Vector2d& p : {Vector2d(t, 0.05 * t), Vector2d(0.05 * t, t), Vector2d(0.2 * t, 0.3 * t)}) {
      EXPECT_NEAR(both.fluenceAt(p), first.fluenceAt(p) + second.fluenceAt(p), 1e-5 * kLinePeak);
      EXPECT_NEAR(both.fluenceAt(p), swapped.fluenceAt(p), 1e-5 * kLinePeak);
    }
  }
}

TEST(Sheet, DepthGrowsWithEnergyUntilTheBoardIsThrough) {
  Sheet sheet{BoardDescription{}};
  const double half_power_w = 0.5 * kPowerW * sheet.board().cut_fluence_j_mm2 / kLinePeak;
  EXPECT_EQ(sheet.depthAt({0.0, 0.0}), 0.0);
  cutLine(sheet, {-1.0, 0.0}, {1.0, 0.0}, half_power_w);
  EXPECT_NEAR(sheet.depthAt({0.0, 0.0}), 0.5, 1e-3);
  cutLine(sheet, {-1.0, 0.0}, {1.0, 0.0}, 0.5 * half_power_w);
  EXPECT_NEAR(sheet.depthAt({0.0, 0.0}), 0.75, 1e-3);
  cutLine(sheet, {-1.0, 0.0}, {1.0, 0.0}, half_power_w);
  EXPECT_EQ(sheet.depthAt({0.0, 0.0}), 1.0);
}

TEST(Sheet, IsSeamlessAcrossTheTilesOfTheMap) {
  Sheet sheet{BoardDescription{}};
  cutLine(sheet, {-2.0, 0.003}, {2.0, 0.003});
  for (double x = -1.5; x < 1.5; x += 0.0011) {
    EXPECT_NEAR(sheet.fluenceAt({x, 0.003}), sheet.fluenceAt({x + 0.02, 0.003}), 1e-4 * kLinePeak) << x;
  }
}

TEST(Sheet, KnowsWhereItIsUntouched) {
  Sheet sheet{BoardDescription{}};
  EXPECT_TRUE(sheet.untouched({-1e4, -1e4}, {1e4, 1e4}));
  sheet.burn(spotAt({5.0, 5.0}), spotAt({6.0, 5.0}), 0.1);
  EXPECT_FALSE(sheet.untouched({4.0, 4.0}, {7.0, 7.0}));
  EXPECT_FALSE(sheet.untouched({5.5, 5.0}, {5.5, 5.0}));
  EXPECT_FALSE(sheet.untouched({-1e4, -1e4}, {1e4, 1e4}));
  EXPECT_TRUE(sheet.untouched({5.0, 5.4}, {6.0, 7.0}));
  EXPECT_TRUE(sheet.untouched({-1e4, 5.4}, {1e4, 1e4}));
}

TEST(Sheet, ACopyBurnsOnItsOwn) {
  Sheet sheet{BoardDescription{}};
  sheet.burn(spotAt({0.0, 0.0}), spotAt({0.0, 0.0}), 1e-3);
  Sheet copy = sheet;
  copy.burn(spotAt({0.0, 0.0}), spotAt({1.0, 0.0}), 1e-3);
  EXPECT_NEAR(sheet.energyJ(), 1e-3, 1e-7);
  EXPECT_NEAR(copy.energyJ(), 2e-3, 1e-7);
}

TEST(Sheet, ALongStripFitsInMemory) {
  Sheet sheet{BoardDescription{}};
  sheet.burn(spotAt({-800.0, 0.0}), spotAt({0.0, 0.0}), 80.0);
  EXPECT_NEAR(sheet.energyJ(), 80.0, 0.08);
  EXPECT_LT(sheet.bytes(), 12'000'000U);
}

/// Nodes of a box in S, mm.
std::vector<float> nodesIn(const Sheet& sheet, const Vector2d& min_mm, const Vector2d& max_mm) {
  const auto node = [](double mm) { return static_cast<int>(std::lround(mm / Sheet::kCellMm)); };
  const int columns = node(max_mm.x()) - node(min_mm.x());
  const int rows = node(max_mm.y()) - node(min_mm.y());
  std::vector<float> nodes(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  sheet.copyNodes(node(min_mm.x()), node(min_mm.y()), columns, rows, nodes);
  return nodes;
}

TEST(SheetParted, BothPiecesShowWhatTheWholeShows) {
  Sheet whole{BoardDescription{}};
  cutLine(whole, {-7.0, -1.0}, {8.0, 2.0});
  Sheet rest = whole;
  const Sheet piece = rest.part(0.37);
  EXPECT_EQ(nodesIn(piece, {0.37 - Sheet::kBothKeep_mm, -2.0}, {9.0, 3.0}),
            nodesIn(whole, {0.37 - Sheet::kBothKeep_mm, -2.0}, {9.0, 3.0}));
  EXPECT_EQ(nodesIn(rest, {-8.0, -2.0}, {0.37 + Sheet::kBothKeep_mm, 3.0}),
            nodesIn(whole, {-8.0, -2.0}, {0.37 + Sheet::kBothKeep_mm, 3.0}));
  EXPECT_TRUE(rest.untouched({2.0, -2.0}, {9.0, 3.0}));
  EXPECT_TRUE(piece.untouched({-8.0, -2.0}, {-2.0, 3.0}));
}

TEST(SheetParted, GoesOnToBeBurntAsIfWhole) {
  Sheet whole{BoardDescription{}};
  cutLine(whole, {0.0, 0.0}, {8.0, 0.0});
  Sheet rest = whole;
  (void)rest.part(2.0);
  for (Sheet* sheet : {&whole, &rest}) cutLine(*sheet, {-8.0, 1.0}, {1.5, 0.0});
  EXPECT_EQ(nodesIn(rest, {-9.0, -2.0}, {2.0, 3.0}), nodesIn(whole, {-9.0, -2.0}, {2.0, 3.0}));
  EXPECT_FALSE(rest.beamOnPartedWeb());
}

TEST(SheetParted, ABeamOnWebThatHasGoneIsTold) {
  Sheet sheet{BoardDescription{}};
  const Sheet piece = sheet.part(10.0);
  sheet.burn(spotAt({9.5, 0.0}), spotAt({9.6, 0.0}), 1e-3);
  EXPECT_FALSE(sheet.beamOnPartedWeb());
  const double kept_j = sheet.energyJ();
  sheet.burn(spotAt({9.5, 0.0}), spotAt({10.0, 0.0}), 1e-3);
  EXPECT_TRUE(sheet.beamOnPartedWeb());
  EXPECT_EQ(sheet.energyJ(), kept_j);
  EXPECT_EQ(piece.energyJ(), 0.0);
}

TEST(SheetParted, AWebOfAnyLengthTakesTheMemoryOfOnePiece) {
  std::vector<std::size_t> bytes;
  for (const int units : {10, 40}) {
    Sheet web{BoardDescription{}};
    for (int unit = 0; unit < units; ++unit) {
      const double x_mm = -30.0 * unit;
      cutLine(web, {x_mm - 20.0, 0.0}, {x_mm, 0.0});
      (void)web.part(x_mm - 25.0);
    }
    bytes.push_back(web.bytes());
  }
  EXPECT_LE(bytes[1], bytes[0] + 4 * 4160);
  EXPECT_LT(bytes[1], 600'000U);
}

TEST(Sheet, RefusesWhatCannotBeBurnt) {
  Sheet sheet{BoardDescription{}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sheet.burn(spotAt({0, 0}), spotAt({0, 0}), nan), std::invalid_argument);
  EXPECT_THROW(sheet.burn(spotAt({0, 0}), spotAt({0, 0}), -1.0), std::invalid_argument);
  EXPECT_THROW(sheet.burn(spotAt({0, nan}), spotAt({0, 0}), 1.0), std::invalid_argument);
  EXPECT_THROW(sheet.burn(spotAt({0, 0}), {{0, 0}, 0.0, 0.1}, 1.0), std::invalid_argument);
  EXPECT_THROW(sheet.burn(spotAt({0, 0}), spotAt({1e9, 0}), 1.0), std::invalid_argument);
  EXPECT_NO_THROW(sheet.burn(spotAt({0, 0}), spotAt({0, 0}), 0.0));
  EXPECT_EQ(sheet.energyJ(), 0.0);
}

TEST(Sheet, NamesEveryFaultOfABoard) {
  try {
    Sheet sheet(BoardDescription{
        .thickness_mm = 0, .cut_fluence_j_mm2 = -1, .transmission = 2, .print_transmission = 0});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& fault) {
    const std::string text = fault.what();
    for (const char* name : {"thickness_mm", "cut_fluence_j_mm2", "transmission", "print_transmission"}) {
      EXPECT_NE(text.find(name), std::string::npos) << name;
    }
  }
}

}  // namespace
}  // namespace kerfbench::twin
