// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/twin/camera/cameras.h"
#include "twin/base/image.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr double kGlow = 4.0;

PrintLayout fourMarks() {
  PrintLayout print;
  print.units = 3;
  print.pitch_mm = 60.0;
  for (const Vector2d& p : {Vector2d(0, -30), Vector2d(40, -30), Vector2d(0, 30), Vector2d(40, 30)}) {
    print.marks.push_back({p, 3.0});
  }
  return print;
}
PrintLayout blank() {
  PrintLayout print;
  print.pitch_mm = 100.0;
  return print;
}
CameraDescription camera1() { return cameraAbove(1200, 1000, 0.1); }

ExposureSample spotAt(const Vector2d& p_WQ_mm, double power_w = 25.0) {
  return {.p_WQ_mm = p_WQ_mm, .radius_mm = 0.105, .power_w = power_w};
}
ExposureSample webAt(const Vector2d& p_WS_mm, double angle_rad = 0.0) {
  return {.p_WS_mm = p_WS_mm, .angle_rad = angle_rad};
}

TEST(SpotCamera, ASpotThatRestsIsWhereItsProjectionIs) {
  const CameraDescription description = withoutNoise(camera1());
  const SpotCamera camera(description, blank(), kGlow, 1);
  const PlaneProjection projection(description);
  for (const Vector2d& p :
       {Vector2d(0, 0), Vector2d(40.03, 31.07), Vector2d(-48.81, 22.22), Vector2d(33.3, -37.77)}) {
    const Frame frame = camera.render({.sequence = 5, .samples = {spotAt(p)}});
    const Vector2d truth = *projection.pixelOf(p);
    EXPECT_LT((centroidAround(frame.image, truth, 9, 110.0).pixel - truth).norm(), 0.02);
  }
}

TEST(SpotCamera, ASmearedSpotIsCentredOnItsWayAndKeepsItsLight) {
  const CameraDescription description = withoutNoise(camera1());
  const SpotCamera camera(description, blank(), kGlow, 1);
  const PlaneProjection projection(description);
  const Vector2d middle(20.0, -10.0);
  const double still = centroidAround(camera.render({.samples = {spotAt(middle)}}).image,
                                      *projection.pixelOf(middle), 12, 110.0)
                           .sum;
  for (const double length_mm : {0.2, 0.5, 1.0}) {
    for (const int samples : {2, 5, 11}) {
      Exposure exposure;
      for (int i = 0; i < samples; ++i) {
        const double along_mm = length_mm * ((i + 0.5) / samples - 0.5);
        exposure.samples.push_back(spotAt(middle + along_mm * Vector2d(0.8, 0.6)));
      }
      const Frame frame = camera.render(exposure);
      const Centroid found = centroidAround(frame.image, *projection.pixelOf(middle), 14, 110.0);
      EXPECT_LT((found.pixel - *projection.pixelOf(middle)).norm(), 0.02);
      EXPECT_NEAR(found.sum, still, 0.03 * still);
    }
  }
}

TEST(SpotCamera, ThePeakIsTheGlowTimesThePowerUntilItSaturates) {
  CameraDescription description = withoutNoise(camera1());
  description.board_gray = 20.0;
  const SpotCamera camera(description, blank(), kGlow, 1);
  const PlaneProjection projection(description);
  const Vector2d p = *projection.planePointOf({700.0, 400.0});
  for (const double power_w : {1.0, 10.0, 50.0}) {
    EXPECT_NEAR(camera.render({.samples = {spotAt(p, power_w)}}).image.at(700, 400), 20.0 + kGlow * power_w,
                0.6);
  }
  EXPECT_EQ(camera.render({.samples = {spotAt(p, 200.0)}}).image.at(700, 400), 255);
  // The laser is on for half of the exposure: half of the light.
  EXPECT_NEAR(camera.render({.samples = {spotAt(p, 40.0), spotAt(p, 0.0)}}).image.at(700, 400),
              20.0 + kGlow * 20.0, 0.6);
  EXPECT_EQ(camera.render({.samples = {spotAt(p, 0.0)}}).image.at(700, 400), 20);
}

TEST(SpotCamera, MarksOfEveryUnitInViewAreWhereTheWebCarriesThem) {
  const CameraDescription description = withoutNoise(camera1());
  const PrintLayout print = fourMarks();
  const SpotCamera camera(description, print, kGlow, 1);
  const PlaneProjection projection(description);
  const Vector2d p_WS_mm(12.34, 1.23);
  const double angle_rad = 0.01;
  const Frame frame = camera.render({.samples = {webAt(p_WS_mm, angle_rad)}});
  int seen = 0;
  double light = 0.0;
  for (int unit = 0; unit < print.units; ++unit) {
    for (const RegistrationMark& mark : print.marks) {
      const Vector2d p_WM =
          p_WS_mm + Eigen::Rotation2Dd(angle_rad) * (mark.p_SM_mm - Vector2d(60.0 * unit, 0.0));
      const Vector2d truth = *projection.pixelOf(p_WM);
      if (truth.x() < 25 || truth.x() > 1174 || truth.y() < 25 || truth.y() > 974) continue;
      ++seen;
      const Centroid found = centroidAround(frame.image, truth, 24, 110.0);
      // The picture of a disc's centre is not quite the centre of its picture: 0.003 px here.
      EXPECT_LT((found.pixel - truth).norm(), 0.02) << unit;
      const double area_px = std::numbers::pi * 2.25 * std::abs(projection.jacobianAt(p_WM).determinant());
      EXPECT_NEAR(found.sum, area_px * (110.0 - kMarkGray), 0.005 * found.sum);
      light += found.sum;
    }
  }
  EXPECT_GE(seen, 6);
  double all = 0.0;
  for (const std::uint8_t gray : frame.image.pixels) all += std::abs(gray - 110.0);
  EXPECT_LT(all, 1.3 * light) << "a mark where none should be";
}

TEST(SpotCamera, AMovingWebSmearsItsMarksAboutTheMiddleOfTheExposure) {
  const CameraDescription description = withoutNoise(camera1());
  PrintLayout print = blank();
  print.marks = {{{0.0, 0.0}, 3.0}};
  const SpotCamera camera(description, print, kGlow, 1);
  const Vector2d middle(5.0, 7.0);
  const Vector2d truth = *PlaneProjection(description).pixelOf(middle);
  Exposure exposure;
  for (int i = 0; i < 4; ++i)
    exposure.samples.push_back(webAt(middle + Vector2d(0.5 * ((i + 0.5) / 4 - 0.5), 0.0)));
  const Frame smeared = camera.render(exposure);
  const Frame still = camera.render({.samples = {webAt(middle)}});
  const Centroid found = centroidAround(smeared.image, truth, 30, 110.0);
  EXPECT_LT((found.pixel - truth).norm(), 0.02);
  EXPECT_NEAR(found.sum, centroidAround(still.image, truth, 30, 110.0).sum, 0.003 * found.sum);
  // The smear has 5 px: the edge is half dark over that length.
  const int edge = static_cast<int>(std::lround(truth.x() + 15.0));
  const int row = static_cast<int>(std::lround(truth.y()));
  EXPECT_GT(smeared.image.at(edge + 1, row), still.image.at(edge - 3, row) + 30);
  EXPECT_LT(smeared.image.at(edge + 1, row), still.image.at(edge + 3, row) - 10);
}

TEST(SpotCamera, NoiseIsAsDescribedOnTheBoardAndOnTheMarks) {
  CameraDescription description = camera1();
  description.full_well_electrons = 8000;
  description.read_noise = 1.1;
  PrintLayout print = blank();
  print.marks = {{{0.0, 0.0}, 10.0}};
  const SpotCamera camera(description, print, kGlow, 3);
  const Vector2d centre = *PlaneProjection(description).pixelOf({0.0, 0.0});
  const auto check = [&](int x0, int y0, int side, double level) {
    double sum = 0.0, square = 0.0, pairs = 0.0, count = 0.0;
    for (std::uint64_t sequence = 0; sequence < 40; ++sequence) {
      const Frame frame = camera.render({.sequence = sequence, .samples = {webAt({0, 0})}});
      for (int y = y0; y < y0 + side; ++y) {
        for (int x = x0; x < x0 + side; ++x) {
          const double value = frame.image.at(x, y) - level;
          sum += value;
          square += value * value;
          pairs += value * (frame.image.at(x + 1, y) - level);
          ++count;
        }
      }
    }
    const double variance = level * 255.0 / 8000.0 + 1.1 * 1.1 + 1.0 / 12.0;
    EXPECT_NEAR(sum / count, 0.0, 0.05);
    EXPECT_NEAR(square / count, variance, 0.04 * variance);
    EXPECT_NEAR(pairs / count, 0.0, 0.03 * variance);
  };
  check(100, 100, 50, 110.0);
  check(static_cast<int>(centre.x()) - 25, static_cast<int>(centre.y()) - 25, 50, kMarkGray);
}

TEST(SpotCamera, FramesDoNotShareTheirNoise) {
  const CameraDescription description = camera1();
  PrintLayout print = blank();
  print.marks = {{{0.0, 0.0}, 10.0}};
  const SpotCamera camera(description, print, kGlow, 3);
  const Vector2d centre = *PlaneProjection(description).pixelOf({0.0, 0.0});
  std::vector<GrayImage> images;
  for (std::uint64_t sequence = 0; sequence < 8; ++sequence) {
    images.push_back(camera.render({.sequence = sequence, .samples = {webAt({0, 0})}}).image);
  }
  const auto correlation = [](const GrayImage& a, const GrayImage& b, int x0, int y0, double level) {
    double product = 0.0, square = 0.0;
    for (int y = y0; y < y0 + 50; ++y) {
      for (int x = x0; x < x0 + 50; ++x) {
        product += (a.at(x, y) - level) * (b.at(x, y) - level);
        square += (a.at(x, y) - level) * (a.at(x, y) - level);
      }
    }
    return product / square;
  };
  for (std::size_t a = 0; a < images.size(); ++a) {
    for (std::size_t b = a + 1; b < images.size(); ++b) {
      EXPECT_NEAR(correlation(images[a], images[b], 100, 100, 110.0), 0.0, 0.09) << a << " " << b;
      EXPECT_NEAR(correlation(images[a], images[b], static_cast<int>(centre.x()) - 25,
                              static_cast<int>(centre.y()) - 25, kMarkGray),
                  0.0, 0.09);
    }
  }
}

TEST(SpotCamera, AFrameIsTheSameInAnyOrderAndFromAnyCopy) {
  const SpotCamera camera(camera1(), fourMarks(), kGlow, 7);
  const SpotCamera twin(camera1(), fourMarks(), kGlow, 7);
  const SpotCamera other(camera1(), fourMarks(), kGlow, 8);
  const auto exposure = [](std::uint64_t sequence) {
    ExposureSample sample = spotAt({1.0 * static_cast<double>(sequence), 3.0});
    sample.p_WS_mm = {10.0, 0.0};
    return Exposure{.sequence = sequence, .start_s = 0.5, .samples = {sample}};
  };
  std::vector<Frame> forward;
  for (std::uint64_t s = 0; s < 4; ++s) forward.push_back(camera.render(exposure(s)));
  for (std::uint64_t s = 4; s-- > 0;) {
    EXPECT_EQ(twin.render(exposure(s)).image.pixels, forward[s].image.pixels);
    EXPECT_NE(other.render(exposure(s)).image.pixels, forward[s].image.pixels);
    EXPECT_EQ(forward[s].sequence, s);
    EXPECT_EQ(forward[s].start_s, 0.5);
    EXPECT_EQ(forward[s].exposure_s, 50e-6);
  }
}

TEST(SpotCamera, ThingsAtAndBeyondTheBorderDoNoHarm) {
  const CameraDescription description = withoutNoise(camera1());
  const SpotCamera camera(description, fourMarks(), kGlow, 7);
  const PlaneProjection projection(description);
  for (const Vector2d& pixel :
       {Vector2d(0, 0), Vector2d(1199, 500), Vector2d(600, 999.4), Vector2d(-3, 500), Vector2d(600, 1200)}) {
    ExposureSample sample = spotAt(*projection.planePointOf(pixel));
    sample.p_WS_mm = sample.p_WQ_mm;
    EXPECT_NO_THROW(static_cast<void>(camera.render({.samples = {sample}})));
  }
  EXPECT_NO_THROW(static_cast<void>(camera.render({.samples = {spotAt({1e5, -1e5})}})));
}

TEST(SpotCamera, RefusesWhatIsNotAnExposure) {
  const SpotCamera camera(camera1(), blank(), kGlow, 7);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(camera.render({})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(camera.render({.samples = {spotAt({nan, 0})}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(camera.render({.samples = {spotAt({0, 0}, -1.0)}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(camera.render({.samples = {webAt({0, nan})}})), std::invalid_argument);
}

TEST(SpotCamera, NamesEveryFaultOfItsDescription) {
  CameraDescription description = camera1();
  description.fx_px = 0.0;
  description.read_noise = -1.0;
  description.exposure_s = 1.0;
  PrintLayout print = blank();
  print.units = 0;
  try {
    const SpotCamera camera(description, print, -1.0, 7);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& fault) {
    const std::string text = fault.what();
    for (const char* name : {"fx_px", "read_noise", "exposure_s", "units", "glow_gray_per_w"}) {
      EXPECT_NE(text.find(name), std::string::npos) << name << " in " << text;
    }
  }
}

}  // namespace
}  // namespace kerfbench::twin
