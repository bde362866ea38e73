// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "twin/sheet/sheet.h"

namespace kerfbench::twin {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Matrix2d covariance(const Footprint& spot) {
  const double x = 0.5 * spot.radius_x_mm;
  const double y = 0.5 * spot.radius_y_mm;
  return (Matrix2d() << x * x, spot.correlation * x * y, spot.correlation * x * y, y * y).finished();
}

double gaussian(const Vector2d& p_mm, const Matrix2d& covariance_mm2, double energy_j) {
  return energy_j * std::exp(-0.5 * p_mm.dot(covariance_mm2.inverse() * p_mm)) /
         (2.0 * std::numbers::pi * std::sqrt(covariance_mm2.determinant()));
}

/// Energy, centre and covariance of the fluence around a place; the spline spreads each node by its variance.
struct Moments {
  double energy_j{};
  Vector2d centre_mm{Vector2d::Zero()};
  Matrix2d covariance_mm2{Matrix2d::Zero()};
};
Moments momentsAround(const Sheet& sheet, const Vector2d& p_S_mm, double half_mm) {
  const int column = static_cast<int>(std::floor((p_S_mm.x() - half_mm) / Sheet::kCellMm));
  const int row = static_cast<int>(std::floor((p_S_mm.y() - half_mm) / Sheet::kCellMm));
  const int side = static_cast<int>(2.0 * half_mm / Sheet::kCellMm);
  std::vector<float> nodes(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  sheet.copyNodes(column, row, side, side, nodes);
  Moments moments;
  const auto forEach = [&](auto&& visit) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        visit(Vector2d((column + x) * Sheet::kCellMm, (row + y) * Sheet::kCellMm),
              static_cast<double>(nodes[static_cast<std::size_t>(y * side + x)]));
      }
    }
  };
  double sum = 0.0;
  forEach([&](const Vector2d& p, double node) {
    sum += node;
    moments.centre_mm += node * p;
  });
  moments.centre_mm /= sum;
  forEach([&](const Vector2d& p, double node) {
    const Vector2d d = p - moments.centre_mm;
    moments.covariance_mm2 += node / sum * d * d.transpose();
  });
  moments.covariance_mm2 += Matrix2d::Identity() * Sheet::kCellMm * Sheet::kCellMm / 3.0;
  moments.energy_j = sum * Sheet::kCellMm * Sheet::kCellMm;
  return moments;
}

class SlantedSpot : public testing::TestWithParam<double> {};

TEST_P(SlantedSpot, HasItsMomentsItsPeakAndAllItsEnergy) {
  for (const Vector2d& radii : {Vector2d(0.105, 0.105), Vector2d(0.13, 0.11), Vector2d(0.2, 0.15)}) {
    for (const double shift_mm : {0.0, 0.0049, 0.0137}) {
      Sheet sheet{BoardDescription{}};
      const Footprint spot{{shift_mm - 0.6, 3.2 - 0.7 * shift_mm}, radii.x(), radii.y(), GetParam()};
      sheet.burn(spot, spot, 2e-3);
      const Moments found = momentsAround(sheet, spot.p_SQ_mm, 0.8);
      const Matrix2d expected = covariance(spot);
      EXPECT_NEAR(sheet.energyJ(), 2e-3, 2e-8);
      EXPECT_NEAR(found.energy_j, 2e-3, 2e-8);
      EXPECT_LT((found.centre_mm - spot.p_SQ_mm).norm(), 1e-5);
      EXPECT_LT((found.covariance_mm2 - expected).norm(), 1e-3 * expected.norm());
      const double peak = gaussian(Vector2d::Zero(), expected, 2e-3);
      // The footprint is 0.05 mm across, two and a half nodes.
      const double share = std::abs(GetParam()) < 0.7 ? 1e-3 : 5e-3;
      EXPECT_NEAR(sheet.fluenceAt(spot.p_SQ_mm), peak, share * peak);
      for (double angle = 0.0; angle < 6.28; angle += 0.37) {
        const Vector2d p = 0.09 * Vector2d(std::cos(angle), std::sin(angle));
        EXPECT_NEAR(sheet.fluenceAt(spot.p_SQ_mm + p), gaussian(p, expected, 2e-3), share * peak) << angle;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Correlations, SlantedSpot,
                         testing::Values(-0.8, -0.51, -0.49, -0.2, -0.03, 0.0, 1e-9, 0.1, 0.35, 0.5, 0.6,
                                         0.8));

TEST(Slanted, KeepsItsEnergyHoweverSlimOrSmall) {
  for (const double radius_mm : {0.001, 0.031, 0.05, 0.105, 0.5}) {
    for (const double correlation : {-0.9999, -0.95, -0.3, 0.2, 0.7, 0.99, 0.999999}) {
      for (const double shift_mm : {0.0, 0.0033, 0.0099, 0.0171}) {
        Sheet sheet{BoardDescription{}};
        const Footprint spot{{shift_mm + 1.28, -shift_mm}, radius_mm, 1.2 * radius_mm, correlation};
        sheet.burn(spot, spot, 1e-3);
        EXPECT_NEAR(sheet.energyJ(), 1e-3, 1e-8) << radius_mm << ' ' << correlation;
      }
    }
  }
}

TEST(Slanted, IsTheSameAsAStraightOneSeenFromTheSide) {
  // The ellipse has 0.14 and 0.09 along S's axes; the second is turned by 30 degrees.
  Sheet straight{BoardDescription{}};
  Sheet turned{BoardDescription{}};
  const Footprint plain{{0.5, 0.5}, 0.14, 0.09};
  const Matrix2d turn = Eigen::Rotation2Dd(std::numbers::pi / 6.0).toRotationMatrix();
  const Matrix2d c = turn * covariance(plain) * turn.transpose();
  const Footprint slanted{plain.p_SQ_mm, 2.0 * std::sqrt(c(0, 0)), 2.0 * std::sqrt(c(1, 1)),
                          c(0, 1) / std::sqrt(c(0, 0) * c(1, 1))};
  straight.burn(plain, plain, 1e-3);
  turned.burn(slanted, slanted, 1e-3);
  const double peak = straight.fluenceAt(plain.p_SQ_mm);
  for (double x = -0.2; x < 0.2; x += 0.017) {
    for (double y = -0.2; y < 0.2; y += 0.019) {
      EXPECT_NEAR(turned.fluenceAt(plain.p_SQ_mm + turn * Vector2d(x, y)),
                  straight.fluenceAt(plain.p_SQ_mm + Vector2d(x, y)), 1e-3 * peak);
    }
  }
}

TEST(Slanted, CutsAKerfOfTheWidthThatItShowsAcrossTheCut) {
  const Footprint spot{{0.0, 0.0}, 0.12, 0.11, 0.3};
  for (const double angle_rad : {0.0, 0.7853981634, 2.356194490}) {
    const Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
    const Vector2d across(-along.y(), along.x());
    Sheet sheet{BoardDescription{}};
    Footprint from = spot, to = spot;
    from.p_SQ_mm = Vector2d(0.003, 0.007) - 1.5 * along;
    to.p_SQ_mm = Vector2d(0.003, 0.007) + 1.5 * along;
    sheet.burn(from, to, 0.3);
    const double sigma_mm = std::sqrt(across.dot(covariance(spot) * across));
    const double peak = 0.1 / (sigma_mm * std::sqrt(2.0 * std::numbers::pi));
    for (double y = -0.2; y < 0.2; y += 0.0133) {
      EXPECT_NEAR(sheet.fluenceAt(Vector2d(0.003, 0.007) + y * across),
                  peak * std::exp(-0.5 * y * y / (sigma_mm * sigma_mm)), 5e-4 * peak);
    }
  }
}

TEST(Slanted, MustBeAnEllipse) {
  Sheet sheet{BoardDescription{}};
  for (const double correlation : {1.0, -1.0, 1.5, std::nan("")}) {
    const Footprint spot{{0.0, 0.0}, 0.1, 0.1, correlation};
    EXPECT_THROW(sheet.burn(spot, spot, 1e-3), std::invalid_argument) << correlation;
  }
}

Footprint onArc(double radius_mm, double arc_mm) {
  const double angle = arc_mm / radius_mm;
  return {{0.0137 + radius_mm * std::cos(angle), radius_mm * std::sin(angle)}, 0.105, 0.105};
}

/// Test by chord length: the cut of an arc in chords compared with one in steps of 3 um.
class Chords : public testing::TestWithParam<double> {};

TEST_P(Chords, BendTheCutByNoMoreThanTheHeaderSays) {
  const double radius_mm = 0.5;
  const double length_mm = 1.2;
  Sheet fine{BoardDescription{}};
  Sheet coarse{BoardDescription{}};
  const auto cut = [&](Sheet& sheet, double chord_mm) {
    const int chords = static_cast<int>(std::lround(length_mm / chord_mm));
    for (int i = 0; i < chords; ++i) {
      sheet.burn(onArc(radius_mm, length_mm * i / chords), onArc(radius_mm, length_mm * (i + 1) / chords),
                 0.12 / chords);
    }
  };
  cut(fine, 0.003);
  cut(coarse, GetParam());
  const auto crest = [&](const Sheet& sheet, double arc_mm) {  // Centroid across the cut, from its circle.
    const Vector2d on = onArc(radius_mm, arc_mm).p_SQ_mm;
    const Vector2d out = (on - Vector2d(0.0137, 0.0)) / radius_mm;
    double sum = 0.0, moment = 0.0;
    for (double r = -0.25; r <= 0.25; r += 0.002) {
      const double fluence = sheet.fluenceAt(on + r * out);
      sum += fluence;
      moment += fluence * r;
    }
    return moment / sum;
  };
  const double shift_mm = GetParam() * GetParam() / (12.0 * radius_mm);
  for (double arc_mm = 0.35; arc_mm < 0.85; arc_mm += 0.0113) {
    EXPECT_NEAR(crest(fine, arc_mm) - crest(coarse, arc_mm), shift_mm, 0.25 * shift_mm + 2e-6);
    const Vector2d on = onArc(radius_mm, arc_mm).p_SQ_mm;
    EXPECT_NEAR(coarse.fluenceAt(on), fine.fluenceAt(on), 5e-4 * fine.fluenceAt(on));
  }
}

INSTANTIATE_TEST_SUITE_P(Lengths, Chords, testing::Values(0.01, 0.02, 0.05));

TEST(Chord, EndsAsTheSpotDoes) {
  // The end of a line is the integral of the beam: an error function.
  Sheet sheet{BoardDescription{}};
  sheet.burn({{0.0037, 0.0}}, {{2.0037, 0.0}}, 0.2);
  const double sigma_mm = 0.5 * 0.105;
  const double peak = 0.1 / (sigma_mm * std::sqrt(2.0 * std::numbers::pi));
  for (double x = -0.25; x < 0.25; x += 0.0071) {
    const double expected = 0.5 * peak * std::erfc(-x / (sigma_mm * std::numbers::sqrt2));
    EXPECT_NEAR(sheet.fluenceAt({0.0037 + x, 0.0}), expected, 4e-4 * peak) << x;
  }
}

}  // namespace
}  // namespace kerfbench::twin
