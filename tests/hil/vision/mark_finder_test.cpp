// SPDX-License-Identifier: Apache-2.0
// Marks, and shapes that only look like marks.
#include "hil/vision/marks/mark_finder.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr double kBoard = 120.0;
constexpr double kInk = 20.0;
constexpr double kDiameterMm = 3.0;
const Vector2d kPlace(1.3, -2.2);

class MarkFinder : public ::testing::Test {
 protected:
  CameraCalibration camera = test::tiltedCamera(320, 300, 0.1);
  test::Canvas canvas{camera, kBoard};

  void disc(const Vector2d& p_mm, double diameter_mm, double gray) { canvas.disc(p_mm, diameter_mm, gray); }
  [[nodiscard]] std::optional<FoundMark> seen() {
    canvas.blur(0.7);
    return measureMark(canvas.expose(4, 1), camera, kPlace + Vector2d(0.15, -0.1), kDiameterMm, 0.6);
  }
};

TEST_F(MarkFinder, MeasuresAWholeDiscOfTheRightSize) {
  disc(kPlace, kDiameterMm, kInk);
  const auto mark = seen();
  ASSERT_TRUE(mark);
  EXPECT_LT((mark->p_mm - kPlace).norm(), 4.0 * mark->sigma_mm);
  EXPECT_LT(mark->sigma_mm, 0.005);
}

/// Mean uncertainty, mm, of large discs in light that changes by this share from pixel to pixel.
double statedUnder(double slope) {
  constexpr int kSide = 200;
  constexpr double kRadiusPx = 66.0;
  CameraCalibration camera = test::tiltedCamera(kSide, kSide, 0.1);
  const double scale = 0.1;  // Scale of the disc, mm to the pixel; the camera's tilt is left out.
  const Vector2d middle = camera.planeFromPixel({0.5 * kSide, 0.5 * kSide});
  double sum = 0.0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    GrayImage image(kSide, kSide);
    const CounterRandom random(seed, 3);
    for (int r = 0; r < kSide; ++r) {
      for (int c = 0; c < kSide; ++c) {
        const Vector2d p_mm = camera.planeFromPixel(Vector2d(c, r)) - middle;
        const double ink = 0.5 * std::erfc((p_mm.norm() / scale - kRadiusPx) / (std::sqrt(2.0) * 0.7));
        const double noise = 0.8 * random.normal(static_cast<std::uint64_t>(r * kSide + c));
        const double gray = (kBoard - (kBoard - kInk) * ink) * (1.0 + slope * (c - 0.5 * kSide)) + noise;
        image.at(c, r) = static_cast<std::uint8_t>(std::lround(gray));
      }
    }
    const auto mark = measureMark(image, camera, middle, 2.0 * kRadiusPx * scale, 0.3);
    EXPECT_TRUE(mark) << seed;
    sum += mark ? mark->sigma_mm / 8.0 : 0.0;
  }
  return sum;
}

TEST(MarkUncertainty, ALampAtOneSideIsNoNoise) {
  const double even_mm = statedUnder(0.0);
  EXPECT_GT(even_mm, 1e-5);
  EXPECT_NEAR(statedUnder(8e-4), even_mm, 0.15 * even_mm);
}

/// A disc beside the middle of a pixel, found by searching and by what the picture before has told.
class KnownMark : public ::testing::Test {
 protected:
  CameraCalibration camera = test::tiltedCamera(320, 300, 0.1);
  [[nodiscard]] GrayImage picture(const Vector2d& p_mm, std::uint64_t seed) const {
    test::Canvas canvas(camera, kBoard);
    canvas.disc(p_mm, kDiameterMm, kInk);
    canvas.blur(0.7);
    return canvas.expose(4, seed);
  }
  [[nodiscard]] std::optional<FoundMark> seen(const GrayImage& image, const Vector2d& near_mm,
                                              const std::optional<MarkLevels>& known = std::nullopt) const {
    return measureMark(image, camera, near_mm, kDiameterMm, 0.6, known);
  }
};

/// A prediction is off by a hundredth of a pixel and more, in any direction.
Vector2d nearly(const Vector2d& p_mm, std::uint64_t seed) {
  const double turn = 0.7 * static_cast<double>(seed);
  return p_mm + 0.0015 * Vector2d(std::cos(turn), std::sin(turn));
}

TEST_F(KnownMark, WithTheLevelsOfItsOwnPictureIsWhereASearchFindsIt) {
  for (std::uint64_t seed = 2; seed < 12; ++seed) {
    const Vector2d moved = kPlace + Vector2d(0.013 * static_cast<double>(seed), 0.02);
    const GrayImage image = picture(moved, seed);
    const auto searched = seen(image, moved + Vector2d(0.1, 0.1));
    ASSERT_TRUE(searched) << seed;
    const auto known = seen(image, nearly(moved, seed), searched->levels);
    ASSERT_TRUE(known) << seed;
    EXPECT_LT((known->p_mm - searched->p_mm).norm(), 0.2 * searched->sigma_mm) << seed;
    EXPECT_NEAR(known->sigma_mm, searched->sigma_mm, 0.1 * searched->sigma_mm) << seed;
    EXPECT_NEAR(known->levels.board, searched->levels.board, 0.1) << seed;
  }
}

TEST_F(KnownMark, WithThoseOfThePictureBeforeIsNoWorseThanASearch) {
  std::optional<MarkLevels> before;
  double by_search = 0.0;
  double by_known = 0.0;
  double stated = 0.0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    const Vector2d moved = kPlace + 0.0021 * static_cast<double>(seed) * Vector2d(1.0, 0.3);
    const GrayImage image = picture(moved, seed);
    const auto searched = seen(image, moved + Vector2d(0.1, 0.1));
    ASSERT_TRUE(searched) << seed;
    if (before) {
      const auto known = seen(image, nearly(moved, seed), before);
      ASSERT_TRUE(known) << seed;
      by_search += (searched->p_mm - moved).squaredNorm();
      by_known += (known->p_mm - moved).squaredNorm();
      stated += 2.0 * known->sigma_mm * known->sigma_mm;
    }
    before = searched->levels;
  }
  // The mean of so many squares is known to a tenth; that of their ratio is known far better, for the noise
  // of the edge is the same.
  EXPECT_NEAR(by_known / by_search, 1.0, 0.1);
  EXPECT_NEAR(by_known / stated, 1.0, 0.3);
}

TEST_F(KnownMark, WithThoseOfManyPicturesIsBetterThanASearchAndSaysSo) {
  std::optional<MarkLevels> before;
  double by_search = 0.0;
  double by_known = 0.0;
  double searched_stated = 0.0;
  double stated = 0.0;
  for (std::uint64_t seed = 1; seed <= 170; ++seed) {
    const Vector2d moved = kPlace + 0.0021 * static_cast<double>(seed) * Vector2d(1.0, 0.3);
    const GrayImage image = picture(moved, seed);
    const auto searched = seen(image, moved + Vector2d(0.1, 0.1));
    ASSERT_TRUE(searched) << seed;
    if (!before) before = searched->levels;
    if (seed > 20) {
      const auto known = seen(image, nearly(moved, seed), before);
      ASSERT_TRUE(known) << seed;
      by_search += (searched->p_mm - moved).squaredNorm();
      by_known += (known->p_mm - moved).squaredNorm();
      searched_stated += 2.0 * searched->sigma_mm * searched->sigma_mm;
      stated += 2.0 * known->sigma_mm * known->sigma_mm;
    }
    before->average(searched->levels, 16.0);
  }
  EXPECT_LT(by_known, 0.95 * by_search);
  EXPECT_LT(stated, 0.95 * searched_stated);
  EXPECT_NEAR(by_known / stated, 1.0, 0.3);
}

TEST_F(KnownMark, IsSearchedForWhereItIsNotWhereItShouldBe) {
  const auto before = seen(picture(kPlace, 1), kPlace);
  ASSERT_TRUE(before);
  for (const Vector2d& jump : {Vector2d(0.03, 0.0), Vector2d(0.15, -0.1), Vector2d(0.0, 0.45)}) {
    const GrayImage image = picture(kPlace + jump, 2);
    const auto searched = seen(image, kPlace);
    const auto known = seen(image, kPlace, before->levels);
    ASSERT_TRUE(searched && known) << jump.transpose();
    EXPECT_LT((known->p_mm - searched->p_mm).norm(), 0.1 * searched->sigma_mm) << jump.transpose();
  }
}

TEST_F(KnownMark, IsMeasuredByTodaysLightNotByYesterdays) {
  const GrayImage image = picture(kPlace, 2);
  const auto searched = seen(image, kPlace);
  ASSERT_TRUE(searched);
  for (const double brighter : {0.6, 0.8, 1.3}) {
    MarkLevels old = searched->levels;
    old.board *= brighter;
    old.ink *= brighter;
    const auto known = seen(image, kPlace, old);
    ASSERT_TRUE(known) << brighter;
    EXPECT_LT((known->p_mm - searched->p_mm).norm(), 1e-9) << brighter;
    EXPECT_NEAR(known->levels.board, searched->levels.board, 1e-9) << brighter;
  }
}

TEST_F(KnownMark, IsGoneWhereThereIsNone) {
  test::Canvas plain(camera, kBoard);
  EXPECT_FALSE(seen(plain.expose(4, 1), kPlace, MarkLevels{kBoard, kInk}));
}

TEST_F(MarkFinder, ASmallerDiscIsNoMark) {
  disc(kPlace, 0.84 * kDiameterMm, kInk);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ALargerDiscIsNoMark) {
  disc(kPlace, 1.2 * kDiameterMm, kInk);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ADiscWithAHoleIsNoMark) {
  disc(kPlace, kDiameterMm, kInk);
  disc(kPlace + Vector2d(0.3, 0.2), 0.9, kBoard);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ADiscWithDirtBesideIsNoMark) {
  disc(kPlace, kDiameterMm, kInk);
  disc(kPlace + Vector2d(0.0, 2.6), 1.6, kInk);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ADiscThatLiesTooFarOffIsAnother) {
  disc(kPlace + Vector2d(2.0, 0.0), kDiameterMm, kInk);
  EXPECT_FALSE(seen());
}

}  // namespace
}  // namespace kerfbench::vision
