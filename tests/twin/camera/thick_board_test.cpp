// SPDX-License-Identifier: Apache-2.0
// A camera that looks aslant at thick board, against lines of sight that are followed point by point.
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/twin/camera/cameras.h"
#include "twin/base/image.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Isometry2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kThickness_mm = 0.4;

PrintLayout noPrint() {
  PrintLayout print;
  print.pitch_mm = 50.0;
  return print;
}

/// A camera whose only blur is that of its pixels.
CameraDescription sharpCamera() {
  CameraDescription camera = withoutNoise(cameraAbove(640, 480, 0.03));
  camera.psf_sigma_px = 1.0 / std::sqrt(12.0);
  return camera;
}

BoardDescription thickBoard(double threshold) {
  BoardDescription board;
  board.thickness_mm = kThickness_mm;
  if (threshold > 0.0) board.depth_curve = {{threshold, 0.0}, {1.0, 1.0}};
  return board;
}

Sheet cutSheet(const BoardDescription& board) {
  Sheet sheet(board);
  const auto line = [&](const Vector2d& from_mm, const Vector2d& to_mm) {
    const double energy_j =
        1.5 * board.cut_fluence_j_mm2 * 0.105 * std::sqrt(std::numbers::pi / 2.0) * (to_mm - from_mm).norm();
    sheet.burn({from_mm, 0.105, 0.105}, {to_mm, 0.105, 0.105}, energy_j);
  };
  line({-8.0, 5.3}, {8.0, 5.9});
  line({-7.6, -6.0}, {-8.1, 6.0});
  return sheet;
}

/// Share of the thickness that the line of sight through a point of the face goes through board, in V.
double leftAlong(const Sheet& sheet, const CameraDescription& camera, const Isometry2d& X_SV,
                 const Vector2d& p_V_mm) {
  constexpr int kSteps = 600;
  const Vector3d eye = camera.X_CP.inverse().translation();
  const Vector3d axis = camera.X_CP.linear().row(2).transpose();
  const Vector3d way =
      camera.telecentric_mm > 0.0 ? axis : Vector3d(Vector3d(p_V_mm.x(), p_V_mm.y(), 0.0) - eye);
  int within = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double share = (i + 0.5) / kSteps;
    const Vector2d at = p_V_mm + share * kThickness_mm * way.head<2>() / std::abs(way.z());
    if (sheet.depthAt(X_SV * at) < share) ++within;
  }
  return static_cast<double>(within) / kSteps;
}

double grayAt(const Sheet& sheet, const CameraDescription& camera, const Isometry2d& X_SV, int u, int v) {
  constexpr int kSub = 6;
  const PlaneProjection projection(camera);
  double sum = 0.0;
  for (int j = 0; j < kSub; ++j) {
    for (int i = 0; i < kSub; ++i) {
      const Vector2d pixel(u - 0.5 + (i + 0.5) / kSub, v - 0.5 + (j + 0.5) / kSub);
      const double left = leftAlong(sheet, camera, X_SV, *projection.planePointOf(pixel));
      sum += lightThrough(sheet.board().light_law, sheet.board().transmission, left);
    }
  }
  return kOpenKerfGray * sum / (kSub * kSub);
}

class ThickBoardSeen : public testing::TestWithParam<std::tuple<double, bool, LightLaw>> {};

TEST_P(ThickBoardSeen, HasTheLightOfItsLinesOfSight) {
  const auto [threshold, telecentric, law] = GetParam();
  CameraDescription camera = sharpCamera();
  if (telecentric) camera.telecentric_mm = 500.0;
  BoardDescription board = thickBoard(threshold);
  board.light_law = law;
  const Sheet sheet = cutSheet(board);
  const Isometry2d X_TS = Eigen::Translation2d(0.3, -0.4) * Eigen::Rotation2Dd(0.02);
  const Vector2d p_TV_mm(0.7, 0.2);
  const GrayImage image = KerfCamera(camera, noPrint(), 1).render(sheet, 0, p_TV_mm, X_TS);
  const Isometry2d X_SV = X_TS.inverse() * Eigen::Translation2d(p_TV_mm);
  const PlaneProjection projection(camera);
  for (const Vector2d& on_kerf : {Vector2d(-4.0, 5.45), Vector2d(5.0, 5.7875), Vector2d(-7.85, 0.0)}) {
    const Vector2d pixel = *projection.pixelOf(X_SV.inverse() * on_kerf);
    // Walls are steeper than a pixel: what counts is how much light there is, and where its middle lies.
    double seen = 0.0;
    double expected = 0.0;
    Vector2d seen_moment = Vector2d::Zero();
    Vector2d expected_moment = Vector2d::Zero();
    const double board_gray = kOpenKerfGray * board.transmission;
    for (int dv = -6; dv <= 6; ++dv) {
      for (int du = -6; du <= 6; ++du) {
        const int u = static_cast<int>(pixel.x()) + du;
        const int v = static_cast<int>(pixel.y()) + dv;
        const double is = image.at(u, v) - board_gray;
        const double should = grayAt(sheet, camera, X_SV, u, v) - board_gray;
        seen += is;
        expected += should;
        seen_moment += is * Vector2d(du, dv);
        expected_moment += should * Vector2d(du, dv);
      }
    }
    EXPECT_NEAR(seen / expected, 1.0, 0.012);
    const Vector2d apart_px = seen_moment / seen - expected_moment / expected;
    EXPECT_LT(apart_px.norm(), 0.02) << apart_px.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(WallsLensAndLight, ThickBoardSeen,
                         testing::Values(std::tuple(0.0, false, LightLaw::kBeer),
                                         std::tuple(0.9, false, LightLaw::kBeer),
                                         std::tuple(0.9, true, LightLaw::kScatter),
                                         std::tuple(0.5, false, LightLaw::kLinear)));

/// Centre and width of the light of a column of pixels, in rows.
struct Slit {
  double centre{}, width{};
};
Slit slitAt(const GrayImage& image, int u, int v, double board_gray) {
  Slit slit;
  for (int row = v - 20; row <= v + 20; ++row) {
    const double light = (image.at(u, row) - board_gray) / (kOpenKerfGray - board_gray);
    slit.width += light;
    slit.centre += light * row;
  }
  slit.centre /= slit.width;
  return slit;
}

// Shift and narrowing of an upright slit are pure geometry: thickness x slope / 2 and thickness x slope.
TEST(ThickBoardSeenAslant, AnUprightSlitIsDisplacedAndNarrower) {
  CameraDescription camera = withoutNoise(cameraAbove(640, 480, 0.03, 0.0));
  camera.distortion = {};
  // Off the foot of the camera by 40 mm: a slope of 0.08 along y.
  camera.X_CP.translation() =
      Eigen::Vector3d(0.0, 0.0, 500.0) - camera.X_CP.linear() * Eigen::Vector3d(0.0, -40.0, 0.0);
  camera.cy_px += 40.0 / 0.03 * 1.002;
  BoardDescription board = thickBoard(0.98);
  board.transmission = 1e-30;
  board.print_transmission = 1e-30;
  Sheet sheet(board);
  const double energy_j = 1.5 * board.cut_fluence_j_mm2 * 0.105 * std::sqrt(std::numbers::pi / 2.0) * 12.0;
  sheet.burn({{-6.0, 0.0}, 0.105, 0.105}, {{6.0, 0.0}, 0.105, 0.105}, energy_j);
  const auto slit = [&](double thickness_mm) {
    BoardDescription other = board;
    other.thickness_mm = thickness_mm;
    Sheet same(other);
    same.burn({{-6.0, 0.0}, 0.105, 0.105}, {{6.0, 0.0}, 0.105, 0.105}, energy_j);
    const GrayImage image =
        KerfCamera(camera, noPrint(), 1).render(same, 0, {0.0, 0.0}, Isometry2d::Identity());
    const Vector2d pixel = *PlaneProjection(camera).pixelOf({0.0, 0.0});
    return slitAt(image, static_cast<int>(pixel.x()), static_cast<int>(pixel.y()), 0.0);
  };
  const Slit thin = slit(1e-6);
  const Slit thick = slit(kThickness_mm);
  const double way_mm = kThickness_mm * 0.08;
  // The lower face is seen nearer to the foot, which is at smaller y: rows grow against y.
  EXPECT_NEAR((thick.centre - thin.centre) * 0.03, 0.5 * way_mm, 0.0015);
  EXPECT_NEAR((thin.width - thick.width) * 0.03, way_mm, 0.003);
}

/// Board without burn or print, lit within a half angle of 5 degrees, over the same with a diffuse light, at
/// a pixel.
double dimmed(CameraDescription camera, int u, int v) {
  const Sheet sheet(thickBoard(0.0));
  const auto gray = [&] {
    return KerfCamera(camera, noPrint(), 1)
        .render(sheet, 0, Vector2d::Zero(), Isometry2d::Identity())
        .gray(u, v);
  };
  const double diffuse = gray();
  camera.back_light_half_angle_rad = 5.0 / 180.0 * std::numbers::pi;
  return gray() / diffuse;
}

TEST(BackLight, ACollimatedOneIsDarkWhereALensLooksAslant) {
  CameraDescription camera = sharpCamera();
  camera.bits = 12;
  const double half = std::tan(5.0 / 180.0 * std::numbers::pi);
  const PlaneProjection projection(camera);
  for (const auto& [u, v] : {std::pair(20, 20), {320, 240}, {620, 460}}) {
    const Vector2d p_V_mm = *projection.planePointOf(Vector2d(u, v));
    const Vector3d eye = camera.X_CP.inverse().translation();
    const double aslant = (Vector3d(p_V_mm.x(), p_V_mm.y(), 0.0) - eye).head<2>().norm() / eye.z();
    EXPECT_NEAR(dimmed(camera, u, v), std::exp2(-aslant * aslant / (half * half)), 0.01) << u << " " << v;
  }
}

TEST(BackLight, ACollimatedOneLooksTheSameThroughATelecentricLens) {
  CameraDescription camera = sharpCamera();
  camera.telecentric_mm = 500.0;
  const Vector3d axis = camera.X_CP.linear().row(2).transpose();
  const double aslant = axis.head<2>().norm() / std::abs(axis.z()) / std::tan(5.0 / 180.0 * std::numbers::pi);
  camera.bits = 12;
  const double middle = dimmed(camera, 320, 240);
  EXPECT_NEAR(middle, std::exp2(-aslant * aslant), 0.01);
  for (const auto& [u, v] : {std::pair(20, 20), {620, 460}}) EXPECT_NEAR(dimmed(camera, u, v), middle, 0.01);
}

}  // namespace
}  // namespace kerfbench::twin
