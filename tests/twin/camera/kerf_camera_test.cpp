// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/twin/camera/cameras.h"
#include "twin/base/image.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Isometry2d;
using Eigen::Vector2d;

const double kBoardGray = kOpenKerfGray * thinBoard().transmission;

PrintLayout blank(int units = 1) {
  PrintLayout print;
  print.units = units;
  print.pitch_mm = 50.0;
  return print;
}
CameraDescription camera40um() { return cameraAbove(1024, 768, 0.04); }

void cut(Sheet& sheet, const Vector2d& from_mm, const Vector2d& to_mm, double peak_j_mm2 = 0.75) {
  // The peak of a line is sqrt(2/pi) / w of the energy per length.
  const double energy_j = peak_j_mm2 * 0.105 * std::sqrt(std::numbers::pi / 2.0) * (to_mm - from_mm).norm();
  sheet.burn({from_mm, 0.105, 0.105}, {to_mm, 0.105, 0.105}, energy_j);
}

class KerfAt : public testing::TestWithParam<double> {};

TEST_P(KerfAt, IsWhereTheBeamWasWithinATwentiethOfAPixel) {
  const CameraDescription description = withoutNoise(camera40um());
  const KerfCamera camera(description, blank(), 1);
  const PlaneProjection projection(description);
  const Vector2d p_TV_mm(30.0, -20.0);
  const Isometry2d X_TS = Eigen::Translation2d(0.7, -0.4) * Eigen::Rotation2Dd(0.005);
  const Vector2d along(std::cos(GetParam()), std::sin(GetParam()));
  const Vector2d middle(30.517, -19.321);
  Sheet sheet{thinBoard()};
  cut(sheet, middle - 9.0 * along, middle + 9.0 * along);
  const GrayImage image = camera.render(sheet, 0, p_TV_mm, X_TS);
  const auto pixelOn = [&](double station_mm) {
    return *projection.pixelOf(X_TS * Vector2d(middle + station_mm * along) - p_TV_mm);
  };
  const Vector2d direction = pixelOn(1.0) - pixelOn(-1.0);
  // Axis along which the kerf is crossed.
  const int axis = std::abs(direction.x()) > std::abs(direction.y()) ? 1 : 0;
  double squares = 0.0;
  int count = 0;
  for (double rough_mm = -7.0; rough_mm < 7.0; rough_mm += 0.037) {
    // The station has a pixel that lies on a whole row (or column).
    const double line = std::round(pixelOn(rough_mm)[1 - axis]);
    double station_mm = rough_mm;
    for (int i = 0; i < 20; ++i)
      station_mm -= (pixelOn(station_mm)[1 - axis] - line) /
                    (pixelOn(station_mm + 1.0)[1 - axis] - pixelOn(station_mm)[1 - axis]);
    const double truth = pixelOn(station_mm)[axis];
    double sum = 0.0, moment = 0.0;
    for (int i = -10; i <= 10; ++i) {
      const int across = static_cast<int>(std::lround(truth)) + i;
      const int x = axis == 0 ? across : static_cast<int>(line);
      const int y = axis == 0 ? static_cast<int>(line) : across;
      const double light = image.at(x, y) - kBoardGray;
      sum += light;
      moment += light * across;
    }
    EXPECT_NEAR(moment / sum, truth, 0.05) << station_mm;
    squares += (moment / sum - truth) * (moment / sum - truth);
    ++count;
  }
  EXPECT_LT(std::sqrt(squares / count), 0.015);
}

INSTANTIATE_TEST_SUITE_P(Directions, KerfAt,
                         testing::Values(0.0, 0.02, 0.5, 0.7853981634, 1.2, 1.5707963268, 2.4));

/// Burns a patch of 4 x 4 mm of one depth.
void burnPatch(Sheet& sheet, const Vector2d& centre_mm, double depth) {
  const double pitch_mm = 0.05;
  for (double y = -2.0; y <= 2.0; y += pitch_mm) {
    sheet.burn({centre_mm + Vector2d(-2.0, y), 0.105, 0.105}, {centre_mm + Vector2d(2.0, y), 0.105, 0.105},
               depth * sheet.board().cut_fluence_j_mm2 * 4.0 * pitch_mm);
  }
}

TEST(KerfCamera, BoardLetsMoreLightThroughTheDeeperItIsBurnt) {
  const CameraDescription description = withoutNoise(camera40um());
  const KerfCamera camera(description, blank(), 1);
  const PlaneProjection projection(description);
  for (const double depth : {0.0, 0.25, 0.5, 0.75, 1.2}) {
    Sheet sheet{thinBoard()};
    if (depth > 0.0) burnPatch(sheet, {1.0, 2.0}, depth);
    const GrayImage image = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity());
    const Vector2d pixel = *projection.pixelOf({1.0, 2.0});
    const double expected = kOpenKerfGray * std::pow(0.12, 1.0 - std::min(depth, 1.0));
    EXPECT_NEAR(image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())), expected, 1.0) << depth;
    EXPECT_NEAR(image.at(20, 20), kBoardGray, 0.6);
  }
}

TEST(KerfCamera, AWholeKerfHasTheLightOfItsWidth) {
  const CameraDescription description = withoutNoise(camera40um());
  const KerfCamera camera(description, blank(), 1);
  Sheet sheet{thinBoard()};
  cut(sheet, {-30.0, 0.3}, {30.0, 0.3});
  const GrayImage image = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity());
  // The integral of the transmission across the kerf is compared with the light across the picture's middle
  // column.
  double expected_mm = 0.0;
  for (double y = -0.5; y < 0.5; y += 1e-4) {
    const double depth = std::min(1.0, 0.75 / 0.5 * std::exp(-2.0 * y * y / (0.105 * 0.105)));
    expected_mm += (std::pow(0.12, 1.0 - depth) - 0.12) * 1e-4;
  }
  double light = 0.0;
  int columns = 0;
  for (int x = 200; x < 800; ++x, ++columns) {
    for (int y = 0; y < image.height; ++y) light += (image.at(x, y) - std::round(kBoardGray)) / kOpenKerfGray;
  }
  const double px_per_mm = PlaneProjection(description).jacobianAt({0.0, 0.3})(1, 1);
  EXPECT_NEAR(light / columns / std::abs(px_per_mm), expected_mm, 0.02 * expected_mm);
}

/// A board with a threshold at a fifth of what cuts; it scorches at half of that, half a millimetre away.
BoardDescription scorchingBoard() {
  BoardDescription board;
  board.depth_curve = {{0.2, 0.0}, {0.4, 0.5}, {1.0, 1.0}};
  board.scorch = {.fluence_j_mm2 = 0.05, .darkening = 0.3, .shift_mm = {0.5, -0.2}};
  return board;
}

TEST(KerfCamera, HalfDepthLetsTheSquareRootOfTheLightThroughWhateverTheCurve) {
  const CameraDescription description = withoutNoise(camera40um());
  const KerfCamera camera(description, blank(), 1);
  const PlaneProjection projection(description);
  BoardDescription board = scorchingBoard();
  board.scorch = {};
  for (const double depth : {0.0, 0.25, 0.5, 0.75}) {
    Sheet sheet{board};
    // The argument of burnPatch() is a share of the fluence that cuts: 0.4 of it burns half through.
    burnPatch(sheet, {1.0, 2.0}, sheet.depthCurve().fluenceFor_j_mm2(depth) / board.cut_fluence_j_mm2);
    const GrayImage image = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity());
    const Vector2d pixel = *projection.pixelOf({1.0, 2.0});
    EXPECT_NEAR(image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())),
                kOpenKerfGray * std::pow(0.12, 1.0 - depth), 1.0)
        << depth;
  }
}

TEST(KerfCamera, ScorchDarkensBoardAndMarksBesideTheBurn) {
  const CameraDescription description = withoutNoise(camera40um());
  PrintLayout print = blank();
  print.marks = {{{2.5, 1.8}, 1.0}};
  const KerfCamera camera(description, print, 1);
  const PlaneProjection projection(description);
  Sheet sheet{scorchingBoard()};
  burnPatch(sheet, {1.0, 2.0}, 0.15);  // The fluence is below the threshold: scorched, not burnt.
  const GrayImage image = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity());
  const auto grayAt = [&](const Vector2d& p_S_mm) {
    const Vector2d pixel = *projection.pixelOf(p_S_mm);
    return static_cast<double>(
        image.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))));
  };
  EXPECT_NEAR(grayAt({1.5, 1.8}), 0.7 * kBoardGray, 0.6);
  EXPECT_NEAR(grayAt({3.3, 1.8}), 0.7 * kBoardGray, 0.6);
  EXPECT_NEAR(grayAt({-1.2, 1.8}), kBoardGray, 0.6);
  EXPECT_NEAR(grayAt({3.8, 1.8}), kBoardGray, 0.6);
  EXPECT_NEAR(grayAt({2.5, 1.8}), 0.7 * 0.02 * kOpenKerfGray, 0.6);
  // The web was cut apart after the burning: the scorch stays on its piece, on whichever side its cause lay.
  const GrayImage piece = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity(), {.min_x_S_mm = 3.2});
  const auto pieceAt = [&](double x_mm) {
    const Vector2d pixel = *projection.pixelOf({x_mm, 1.8});
    return static_cast<double>(
        piece.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))));
  };
  EXPECT_NEAR(pieceAt(3.35), 0.7 * kBoardGray, 0.6);
  EXPECT_NEAR(pieceAt(1.5), kBoardGray, 0.6);
}

/// A camera straight above the table, its rows along the kerf: nothing but the camera itself smooths the
/// kerf's edges.
CameraDescription squareCamera() {
  CameraDescription camera = withoutNoise(cameraAbove(1024, 768, 0.04, 0.0));
  camera.distortion = {};
  camera.fy_px = camera.fx_px;
  return camera;
}

/// Place of the kerf, mm.
class ScorchedKerf : public testing::TestWithParam<double> {};

TEST_P(ScorchedKerf, HasTheLightOfItsWidthLessTheScorchOnOneSide) {
  const CameraDescription description = squareCamera();
  const KerfCamera camera(description, blank(), 1);
  const PlaneProjection projection(description);
  BoardDescription board;
  board.scorch = {.fluence_j_mm2 = 0.25, .darkening = 0.5, .shift_mm = {0.0, 0.08}};
  Sheet sheet{board};
  cut(sheet, {-30.0, GetParam()}, {30.0, GetParam()}, 1.0);
  const GrayImage image = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity());
  double expected_mm = 0.0, expected_moment_mm2 = 0.0;
  for (double y = -0.5; y < 0.5; y += 1e-4) {
    const auto line = [](double across_mm) {
      return std::exp(-2.0 * across_mm * across_mm / (0.105 * 0.105));
    };
    const double depth = std::min(1.0, 2.0 * line(y));
    const double scorch = std::min(1.0, 4.0 * line(y - 0.08));
    const double light = depth < 1.0 ? std::pow(0.12, 1.0 - depth) * (1.0 - 0.5 * scorch) : 1.0;
    expected_mm += (light - 0.12) * 1e-4;
    expected_moment_mm2 += (light - 0.12) * y * 1e-4;
  }
  ASSERT_LT(expected_moment_mm2 / expected_mm, -0.004);  // An invisible scorch proves nothing.
  double light = 0.0, moment = 0.0;
  int columns = 0;
  for (int x = 300; x < 700; ++x, ++columns) {
    const double row = projection.pixelOf({projection.planePointOf({x * 1.0, 384.0})->x(), GetParam()})->y();
    for (int y = static_cast<int>(row) - 25; y < static_cast<int>(row) + 26; ++y) {
      const double above = (image.at(x, y) - std::round(kBoardGray)) / kOpenKerfGray;
      light += above;
      moment += above * (y - row);
    }
  }
  const double px_per_mm = projection.jacobianAt({0.0, GetParam()})(1, 1);
  EXPECT_NEAR(light / columns / std::abs(px_per_mm), expected_mm, 0.01 * expected_mm);
  EXPECT_NEAR(moment / light / px_per_mm, expected_moment_mm2 / expected_mm, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Places, ScorchedKerf, testing::Values(0.3, 0.307, 0.313, 0.32, 0.329));

TEST(KerfCamera, MarksAreDarkerThanTheBoardAndInPlace) {
  const CameraDescription description = withoutNoise(camera40um());
  PrintLayout print = blank(3);
  print.marks = {{{3.0, 4.0}, 3.0}, {{-8.0, -5.0}, 2.0}};
  const KerfCamera camera(description, print, 1);
  const PlaneProjection projection(description);
  const Sheet sheet{thinBoard()};
  const Isometry2d X_TS = Eigen::Translation2d(0.9, -0.8) * Eigen::Rotation2Dd(-0.005);
  const Vector2d p_TV_mm(1.5, -2.5);
  for (const int unit : {0, 2}) {
    const GrayImage image = camera.render(sheet, unit, p_TV_mm, X_TS);
    for (const RegistrationMark& mark : print.marks) {
      const Vector2d p_V = X_TS * mark.p_SM_mm - p_TV_mm;
      const Vector2d truth = *projection.pixelOf(p_V);
      const Centroid found = centroidAround(image, truth, 50, std::round(kBoardGray));
      EXPECT_LT((found.pixel - truth).norm(), 0.03);
      EXPECT_NEAR(image.at(static_cast<int>(truth.x()), static_cast<int>(truth.y())), kOpenKerfGray * 0.02,
                  0.6);
    }
  }
}

TEST(KerfCamera, AUnitShowsWhatWasBurntOnePitchUpstream) {
  const CameraDescription description = withoutNoise(camera40um());
  const KerfCamera camera(description, blank(2), 1);
  const PlaneProjection projection(description);
  Sheet sheet{thinBoard()};
  cut(sheet, {-50.0 + 3.0, 0.0}, {-50.0 + 3.0, 5.0});
  const Vector2d pixel = *projection.pixelOf({3.0, 2.5});
  const auto level = [&](int unit, const PieceSpan& piece) {
    return camera.render(sheet, unit, {0, 0}, Isometry2d::Identity(), piece)
        .at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  };
  EXPECT_NEAR(level(0, {}), kBoardGray, 0.6);
  EXPECT_GT(level(1, {}), 200);
  EXPECT_GT(level(1, {.min_x_S_mm = 2.0}), 200);
  EXPECT_NEAR(level(1, {.min_x_S_mm = 4.0}), kBoardGray, 0.6);
  EXPECT_NEAR(level(1, {.max_x_S_mm = 2.0}), kBoardGray, 0.6);
}

TEST(KerfCamera, NoiseIsAsDescribedAndFreshForEachTile) {
  CameraDescription description = camera40um();
  description.read_noise = 1.3;
  const KerfCamera camera(description, blank(2), 5);
  const Sheet sheet{thinBoard()};
  const GrayImage image = camera.render(sheet, 0, {0, 0}, Isometry2d::Identity());
  double sum = 0.0, square = 0.0;
  for (const std::uint8_t gray : image.pixels) {
    sum += gray - kBoardGray;
    square += (gray - kBoardGray) * (gray - kBoardGray);
  }
  const auto count = static_cast<double>(image.pixels.size());
  const double variance = kBoardGray * 255.0 / 10000.0 + 1.3 * 1.3 + 1.0 / 12.0;
  EXPECT_NEAR(sum / count, 0.0, 0.01);
  EXPECT_NEAR(square / count, variance, 0.01 * variance);

  EXPECT_EQ(camera.render(sheet, 0, {0, 0}, Isometry2d::Identity()).pixels, image.pixels);
  const auto correlation = [&](const GrayImage& other) {
    double product = 0.0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      product += (image.pixels[i] - kBoardGray) * (other.pixels[i] - kBoardGray);
    return product / square;
  };
  EXPECT_NEAR(correlation(camera.render(sheet, 0, {1, 0}, Isometry2d::Identity())), 0.0, 0.005);
  EXPECT_NEAR(correlation(camera.render(sheet, 1, {0, 0}, Isometry2d::Identity())), 0.0, 0.005);
  EXPECT_NEAR(
      correlation(KerfCamera(description, blank(2), 6).render(sheet, 0, {0, 0}, Isometry2d::Identity())), 0.0,
      0.005);
}

TEST(KerfCamera, RefusesWhatItCannotRender) {
  const KerfCamera camera(camera40um(), blank(2), 5);
  const Sheet sheet{thinBoard()};
  EXPECT_THROW(static_cast<void>(camera.render(sheet, 2, {0, 0}, Isometry2d::Identity())),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(camera.render(sheet, -1, {0, 0}, Isometry2d::Identity())),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(camera.render(sheet, 0, {1e9, 0}, Isometry2d::Identity())),
               std::invalid_argument);
  CameraDescription slow = camera40um();
  // The exposure is longer than the spot camera's frame period, which does not matter here.
  slow.exposure_s = 0.02;
  EXPECT_NO_THROW(KerfCamera(slow, blank(), 5));
  CameraDescription blurred = camera40um();
  blurred.psf_sigma_px = 3.0;
  EXPECT_THROW(KerfCamera(blurred, blank(), 5), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin
