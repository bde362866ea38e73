// SPDX-License-Identifier: Apache-2.0
// Imperfections of the spot camera: each is as its description says, and moves with the part that it belongs
// to.
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <opencv2/core.hpp>

#include "tests/twin/camera/cameras.h"
#include "tests/twin/camera/statistics.h"
#include "twin/base/image.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr double kGlow = 4.0;
constexpr double kBoard = 110.0;

PrintLayout blank() {
  PrintLayout print;
  print.pitch_mm = 100.0;
  return print;
}

/// A camera straight above, without distortion, 0.1 mm to the pixel: 1 mm of the web is 10 px.
CameraDescription straight(int width = 400, int height = 300) {
  CameraDescription camera = withoutNoise(cameraAbove(width, height, 0.1, 0.0));
  camera.fy_px = camera.fx_px;
  camera.distortion = {};
  camera.bits = 12;
  return camera;
}

Exposure webAt(const Vector2d& p_WS_mm, std::uint64_t sequence = 0) {
  return {.sequence = sequence, .samples = {{.p_WS_mm = p_WS_mm}}};
}
Exposure spotAt(const Vector2d& p_WQ_mm, const Vector2d& p_WS_mm = {0, 0}, std::uint64_t sequence = 0) {
  return {.sequence = sequence,
          .samples = {{.p_WQ_mm = p_WQ_mm, .radius_mm = 0.3, .power_w = 25.0, .p_WS_mm = p_WS_mm}}};
}

GrayImage render(const CameraDescription& description, const Exposure& exposure, std::uint64_t seed = 1,
                 const PrintLayout& print = blank()) {
  return SpotCamera(description, print, kGlow, seed).render(exposure).image;
}

const Region kMost{30, 30, 340, 240};

TEST(HardSpotCamera, GrainHasItsRmsAndItsLength) {
  CameraDescription description = straight();
  description.texture = {.grain_gray = 6.0, .grain_length_mm = 0.3};
  const GrayImage image = render(description, webAt({0, 0}));
  const Moments moments = momentsOf(image, kMost);
  EXPECT_NEAR(moments.mean, kBoard, 0.2);
  EXPECT_NEAR(moments.rms, 6.0, 0.2);
  EXPECT_NEAR(correlationOf(image, image, kMost, 3, 0), std::exp(-1.0), 0.04);
  EXPECT_NEAR(correlationOf(image, image, kMost, 0, 3), std::exp(-1.0), 0.04);
  EXPECT_NEAR(correlationOf(image, image, kMost, 0, 12), 0.0, 0.04);
}

TEST(HardSpotCamera, GrainMovesWithTheBoardAndDoesNotAverageAway) {
  CameraDescription description = straight();
  description.read_noise = 2.0;
  description.texture.grain_gray = 4.0;
  const SpotCamera camera(description, blank(), kGlow, 3);
  const GrayImage first = camera.render(webAt({0, 0}, 1)).image;
  // The web moves by 1.3 mm along x and -0.7 mm along y, which runs against the rows.
  const GrayImage moved = camera.render(webAt({1.3, -0.7}, 2)).image;
  const double grain_share = 16.0 / (16.0 + 4.0);
  EXPECT_NEAR(correlationOf(first, moved, kMost, 13, 7), grain_share, 0.02);
  EXPECT_NEAR(correlationOf(first, moved, kMost, 0, 0), 0.0, 0.03);
  // A camera with another seed has other noise over the same board; another board has other grain.
  EXPECT_NEAR(correlationOf(first, render(description, webAt({0, 0}, 1), 4), kMost, 0, 0), grain_share, 0.02);
  description.board_seed = 2;
  EXPECT_NEAR(correlationOf(first, render(description, webAt({0, 0}, 1), 4), kMost, 0, 0), 0.0, 0.03);

  std::vector<double> sum(static_cast<std::size_t>(kMost.width), 0.0);
  double square = 0.0;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const GrayImage image = camera.render(webAt({0.1 * static_cast<double>(i % 20), 0.0}, 10 + i)).image;
    for (int x = 0; x < kMost.width; ++x)
      sum[static_cast<std::size_t>(x)] += image.gray(x + 30 + static_cast<int>(i % 20), 100) / 50.0;
  }
  for (const double mean : sum) square += (mean - kBoard) * (mean - kBoard) / kMost.width;
  EXPECT_NEAR(std::sqrt(square), 4.0, 0.7);
}

TEST(HardSpotCamera, AFastWebSmearsItsGrain) {
  CameraDescription description = straight();
  description.texture = {.grain_gray = 6.0, .grain_length_mm = 0.15};
  Exposure exposure;
  for (int i = 0; i < 4; ++i) exposure.samples.push_back({.p_WS_mm = {0.2 * i, 0.0}});
  EXPECT_LT(momentsOf(render(description, exposure), kMost).rms, 4.0);
}

TEST(HardSpotCamera, InkHasLessGrainAsItHasLessLight) {
  CameraDescription description = straight();
  description.texture.grain_gray = 6.0;
  PrintLayout print = blank();
  print.areas = {{.p_SA_mm = {0.0, 0.0}, .size_mm = {20.0, 15.0}}};
  const GrayImage image = render(description, webAt({0, 0}), 1, print);
  const Moments ink = momentsOf(image, {120, 100, 160, 100});
  EXPECT_NEAR(ink.mean, kMarkGray, 0.3);
  EXPECT_NEAR(ink.rms, 6.0 * kMarkGray / kBoard, 0.1);
}

TEST(HardSpotCamera, GrainAroundPrintAndSpotIsTheGrainOfTheWholeBoard) {
  CameraDescription description = straight();
  description.texture.grain_gray = 5.0;
  PrintLayout print = blank();
  print.marks = {{{-8.0, 5.0}, 3.0}};
  const GrayImage whole = render(description, spotAt({8.0, -4.0}, {0.33, 0.21}), 1, print);
  description.texture.grain_everywhere = false;
  const GrayImage parts = render(description, spotAt({8.0, -4.0}, {0.33, 0.21}), 1, print);
  const PlaneProjection projection(description);
  for (const Vector2d& p_W_mm : {Vector2d(-7.67, 5.21), Vector2d(8.0, -4.0)}) {
    const Vector2d pixel = *projection.pixelOf(p_W_mm);
    for (int y = static_cast<int>(pixel.y()) - 17; y <= static_cast<int>(pixel.y()) + 17; ++y) {
      for (int x = static_cast<int>(pixel.x()) - 17; x <= static_cast<int>(pixel.x()) + 17; ++x)
        EXPECT_NEAR(parts.gray(x, y), whole.gray(x, y), 0.13);
    }
  }
  EXPECT_GT(momentsOf(whole, {10, 200, 80, 80}).rms, 4.5);
  EXPECT_EQ(momentsOf(parts, {10, 200, 80, 80}).rms, 0.0);
}

TEST(HardSpotCamera, TheBoardMultipliesTheSpotAndCarriesThatWithIt) {
  CameraDescription description = straight();
  description.board_gray = 20.0;
  CameraDescription textured = description;
  textured.texture = {.glow_share = 0.15, .glow_length_mm = 0.15};
  double sum = 0.0, square = 0.0, count = 0.0;
  for (int i = 0; i < 60; ++i) {
    const Vector2d place(1.5 * (i % 10) - 7.0, 1.5 * (i / 10) - 4.0);
    const GrayImage plain = render(description, spotAt(place));
    const GrayImage image = render(textured, spotAt(place));
    const Vector2d pixel = *PlaneProjection(description).pixelOf(place);
    for (int y = static_cast<int>(pixel.y()) - 3; y <= static_cast<int>(pixel.y()) + 3; ++y) {
      for (int x = static_cast<int>(pixel.x()) - 3; x <= static_cast<int>(pixel.x()) + 3; ++x) {
        if (plain.gray(x, y) < 60.0) continue;
        const double change = (image.gray(x, y) - 20.0) / (plain.gray(x, y) - 20.0) - 1.0;
        sum += change;
        square += change * change;
        ++count;
      }
    }
    EXPECT_EQ(image.gray(5, 5), plain.gray(5, 5));
  }
  EXPECT_NEAR(sum / count, 0.0, 0.02);
  EXPECT_NEAR(std::sqrt(square / count), 0.15, 0.01);
  // The second picture has the same board under the same spot, 3 mm further on.
  const GrayImage here = render(textured, spotAt({0.0, 0.0}, {0.0, 0.0}));
  const GrayImage there = render(textured, spotAt({3.0, 0.0}, {3.0, 0.0}));
  const GrayImage elsewhere = render(textured, spotAt({3.0, 0.0}, {1.0, 0.0}));
  const Vector2d pixel = *PlaneProjection(description).pixelOf({0.0, 0.0});
  double differs = 0.0;
  for (int y = static_cast<int>(pixel.y()) - 6; y <= static_cast<int>(pixel.y()) + 6; ++y) {
    for (int x = static_cast<int>(pixel.x()) - 6; x <= static_cast<int>(pixel.x()) + 6; ++x) {
      EXPECT_NEAR(here.gray(x, y), there.gray(x + 30, y), 0.2);
      differs = std::max(differs, std::abs(here.gray(x, y) - elsewhere.gray(x + 30, y)));
    }
  }
  EXPECT_GT(differs, 5.0);
}

struct Light {
  double sum{};
  Vector2d centre_px{Vector2d::Zero()};
};
Light lightAbove(const GrayImage& image, const GrayImage& base) {
  Light light;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double more = image.gray(x, y) - base.gray(x, y);
      light.sum += more;
      light.centre_px += more * Vector2d(x, y);
    }
  }
  light.centre_px /= light.sum;
  return light;
}

TEST(HardSpotCamera, APlumeGlowsBesideTheSpotAsTheDescriptionSays) {
  CameraDescription description = straight();
  CameraDescription smoking = description;
  smoking.plume = {.share = 0.1, .offset_mm = {2.0, 1.0}, .sigma_mm = 0.8};
  const Light light =
      lightAbove(render(smoking, spotAt({1.0, 2.0})), render(description, spotAt({1.0, 2.0})));
  const Vector2d truth = *PlaneProjection(description).pixelOf({3.0, 3.0});
  EXPECT_LT((light.centre_px - truth).norm(), 0.3);
  // The plume is a Gaussian of peak 0.1 * 4/W * 25 W and sigma 8 px, blurred.
  EXPECT_NEAR(light.sum, 10.0 * 2.0 * std::numbers::pi * 64.0, 0.03 * light.sum);
  // Without a spot there is no plume.
  EXPECT_EQ(render(smoking, webAt({0, 0})).levels, render(description, webAt({0, 0})).levels);
}

TEST(HardSpotCamera, APlumeFlickersAndWandersFromFrameToFrame) {
  CameraDescription description = straight();
  const GrayImage base = render(description, spotAt({0.0, 0.0}));
  description.plume = {
      .share = 0.1, .offset_mm = {4.0, 0.0}, .sigma_mm = 0.5, .flicker = 0.25, .wander_mm = 0.3};
  const SpotCamera camera(description, blank(), kGlow, 5);
  const PlaneProjection projection(description);
  double sum = 0.0, square = 0.0;
  Vector2d offsets = Vector2d::Zero(), offset_squares = Vector2d::Zero();
  const int frames = 300;
  for (int i = 0; i < frames; ++i) {
    const Light light =
        lightAbove(camera.render(spotAt({0.0, 0.0}, {0, 0}, static_cast<std::uint64_t>(i))).image, base);
    const double share = light.sum / (100.0 * 2.0 * std::numbers::pi * 25.0);
    const Vector2d offset = *projection.planePointOf(light.centre_px);
    sum += share / frames;
    square += share * share / frames;
    offsets += offset / frames;
    offset_squares += offset.cwiseProduct(offset) / frames;
  }
  EXPECT_NEAR(sum, 0.1, 0.006);
  EXPECT_NEAR(std::sqrt(square - sum * sum), 0.025, 0.005);
  const Vector2d wander = (offset_squares - offsets.cwiseProduct(offsets)).cwiseSqrt();
  EXPECT_LT((offsets - Vector2d(4.0, 0.0)).norm(), 0.06);
  EXPECT_NEAR(wander.x(), 0.3, 0.05);
  EXPECT_NEAR(wander.y(), 0.3, 0.05);
}

TEST(HardSpotCamera, TheLampShadesTheBoardAndTheLensShadesAllLight) {
  CameraDescription description = straight();
  description.light = {.vignette = 0.3, .gradient_x = 0.4, .gradient_y = -0.2};
  const GrayImage image = render(description, webAt({0, 0}));
  const auto expected = [](double x, double y) {
    const double u = x / 399.0 - 0.5, v = y / 299.0 - 0.5;
    const double lamp = 1.0 + 0.4 * u - 0.2 * v;
    const double r2 = (u * u * 399 * 399 + v * v * 299 * 299) / (0.25 * (399.0 * 399.0 + 299.0 * 299.0));
    return lamp * (1.0 - 0.3 * r2);
  };
  for (const auto& [x, y] : {std::pair{0, 0}, {399, 0}, {0, 299}, {399, 299}, {200, 150}, {50, 220}})
    EXPECT_NEAR(image.gray(x, y), kBoard * expected(x, y), 0.3) << x << " " << y;
  // The spot is in the corner: dimmed by the lens, not by the lamp.
  const PlaneProjection projection(description);
  const Vector2d place = *projection.planePointOf({380.0, 20.0});
  const double r2 = (180.5 * 180.5 + 129.5 * 129.5) / (0.25 * (399.0 * 399.0 + 299.0 * 299.0));
  const GrayImage with_spot = render(description, spotAt(place));
  EXPECT_NEAR(with_spot.gray(380, 20) - image.gray(380, 20),
              (1.0 - 0.3 * r2) * (render(straight(), spotAt(place)).gray(380, 20) - kBoard), 0.5);
}

TEST(HardSpotCamera, HotPixelsStayWhereTheyAre) {
  CameraDescription description = straight();
  description.hot = {.share = 1e-3, .gray = 100.0};
  const auto hotIn = [](const GrayImage& image) {
    std::set<std::pair<int, int>> found;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        if (image.gray(x, y) < kBoard + 20.0) continue;
        found.emplace(x, y);
        EXPECT_GE(image.gray(x, y), kBoard + 24.5);
        EXPECT_LE(image.gray(x, y), 256.0);
      }
    }
    return found;
  };
  const auto first = hotIn(render(description, webAt({0, 0}, 1)));
  EXPECT_NEAR(static_cast<double>(first.size()), 120.0, 2.0);
  EXPECT_EQ(hotIn(render(description, webAt({5, 3}, 2), 77)), first);
  // The whole frame rendered afresh has the same hot pixels.
  CameraDescription shaded = description;
  shaded.light.vignette = 1e-6;
  EXPECT_EQ(hotIn(render(shaded, webAt({0, 0}, 1))), first);
  description.hot.seed = 2;
  EXPECT_NE(hotIn(render(description, webAt({0, 0}, 1))), first);
}

TEST(HardSpotCamera, OtherPrintIsDarkWhereItIsAndMovesWithTheWeb) {
  const CameraDescription description = withoutNoise(cameraAbove(1200, 1000, 0.1));
  PrintLayout print = blank();
  print.areas = {{.p_SA_mm = {3.0, 4.0}, .size_mm = {6.0, 1.2}, .angle_rad = 0.5},
                 {.p_SA_mm = {-20.0, -10.0}, .size_mm = {8.0, 8.0}, .ink = 0.4}};
  const GrayImage image = render(description, webAt({1.5, -2.5}), 1, print);
  const PlaneProjection projection(description);
  for (const PrintedArea& area : print.areas) {
    const Vector2d p_W_mm = area.p_SA_mm + Vector2d(1.5, -2.5);
    const Vector2d truth = *projection.pixelOf(p_W_mm);
    const Centroid found = centroidAround(image, truth, 60, kBoard);
    EXPECT_LT((found.pixel - truth).norm(), 0.05);
    const double area_px = area.size_mm.prod() * std::abs(projection.jacobianAt(p_W_mm).determinant());
    EXPECT_NEAR(found.sum, area_px * area.ink * (kBoard - kMarkGray), 0.01 * found.sum);
    EXPECT_NEAR(image.at(static_cast<int>(truth.x()), static_cast<int>(truth.y())),
                kBoard + area.ink * (kMarkGray - kBoard), 0.6);
  }
  EXPECT_EQ(image.at(100, 900), 110);
  // The area is larger than the picture.
  print.areas = {{.p_SA_mm = {500.0, 0.0}, .size_mm = {1000.0, 2000.0}}};
  const GrayImage half = render(description, webAt({0, 0}), 1, print);
  const Vector2d edge = *projection.pixelOf({0.0, 0.0});
  EXPECT_NEAR(half.at(static_cast<int>(edge.x()) - 20, static_cast<int>(edge.y())), 110, 0.6);
  EXPECT_NEAR(half.at(static_cast<int>(edge.x()) + 20, static_cast<int>(edge.y())), kMarkGray, 0.6);
  EXPECT_NEAR(half.at(1190, 10), kMarkGray, 0.6);
}

TEST(HardSpotCamera, MoreBitsQuantizeLessAndSaturateAtTheirTop) {
  for (const int bits : {8, 10, 12}) {
    CameraDescription description = straight();
    description.bits = bits;
    description.board_gray = 100.3;
    const double step = 1.0 / (1 << (bits - 8));
    const GrayImage plain = render(description, webAt({0, 0}));
    EXPECT_EQ(plain.bits, bits);
    EXPECT_NEAR(plain.gray(7, 7), 100.3, 0.5 * step + 1e-6);
    EXPECT_EQ(plain.at(7, 7), 100);
    EXPECT_EQ(render(description, {.samples = {{.radius_mm = 0.3, .power_w = 900.0}}}).gray(204, 145),
              256.0 - step);
    description.read_noise = 0.8;
    description.full_well_electrons = 10000.0;
    const double variance = 0.64 + 100.3 * 255.0 / 10000.0 + step * step / 12.0;
    EXPECT_NEAR(momentsOf(render(description, webAt({0, 0})), kMost).rms, std::sqrt(variance),
                0.02 * std::sqrt(variance));
  }
}

/// A camera with all imperfections.
CameraDescription hard() {
  CameraDescription description = cameraAbove(400, 300, 0.1);
  description.bits = 10;
  description.texture = {.grain_gray = 3.0, .glow_share = 0.1};
  description.plume = {.share = 0.1, .offset_mm = {1.0, 0.5}, .flicker = 0.3, .wander_mm = 0.2};
  description.light = {.vignette = 0.2, .gradient_x = 0.1};
  description.hot.share = 1e-4;
  return description;
}

TEST(HardSpotCamera, AHardFrameIsTheSameInAnyOrderAndFromAnyCopy) {
  PrintLayout print = blank();
  print.marks = {{{2.0, 1.0}, 3.0}};
  print.areas = {{.p_SA_mm = {-5.0, 3.0}, .size_mm = {4.0, 0.5}, .angle_rad = 0.3}};
  const SpotCamera camera(hard(), print, kGlow, 7);
  const SpotCamera again(hard(), print, kGlow, 7);
  std::vector<GrayImage> forward;
  for (std::uint64_t s = 0; s < 3; ++s)
    forward.push_back(camera.render(spotAt({0.5 * static_cast<double>(s), 1.0}, {0.1, 0.0}, s)).image);
  for (std::uint64_t s = 3; s-- > 0;) {
    EXPECT_EQ(again.render(spotAt({0.5 * static_cast<double>(s), 1.0}, {0.1, 0.0}, s)).image.levels,
              forward[s].levels);
  }
}

TEST(HardSpotCamera, NothingInPlainBoardRepeatsFromFrameToFrame) {
  // Two pictures that share a stretch of noise, wherever it lies in them, would have a peak of their
  // correlation there.
  CameraDescription description = cameraAbove(256, 256, 0.1);
  const SpotCamera camera(description, blank(), kGlow, 3);
  std::vector<cv::Mat> spectra;
  for (std::uint64_t sequence = 0; sequence < 8; ++sequence) {
    const GrayImage image = camera.render(webAt({0, 0}, sequence)).image;
    const Moments moments = momentsOf(image, {0, 0, 256, 256});
    cv::Mat floats(256, 256, CV_32F);
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x)
        floats.at<float>(y, x) =
            static_cast<float>((image.gray(x, y) - moments.mean) / (256.0 * moments.rms));
    }
    cv::dft(floats, spectra.emplace_back(), cv::DFT_COMPLEX_OUTPUT);
  }
  for (std::size_t a = 0; a < spectra.size(); ++a) {
    for (std::size_t b = a + 1; b < spectra.size(); ++b) {
      cv::Mat product, correlation;
      cv::mulSpectrums(spectra[a], spectra[b], product, 0, true);
      cv::dft(product, correlation, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
      double largest = 0.0;
      cv::minMaxLoc(correlation, nullptr, &largest);
      // 65536 places of noise 1/256: the largest of them is some 4.4/256.
      EXPECT_LT(largest, 6.0 / 256.0) << a << " " << b;
    }
  }
}

TEST(HardSpotCamera, NoiseOfPlainBoardAveragesAwayAlongAnyMotion) {
  CameraDescription description = cameraAbove(256, 128, 0.1);
  const SpotCamera camera(description, blank(), kGlow, 3);
  const double sigma = std::sqrt(0.64 + kBoard * 255.0 / 10000.0 + 1.0 / 12.0);
  for (const int dx : {0, 1, 3}) {
    const int frames = 40;
    std::vector<double> mean(100 * 100, 0.0);
    for (int s = 0; s < frames; ++s) {
      const GrayImage image = camera.render(webAt({0, 0}, static_cast<std::uint64_t>(s))).image;
      for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 100; ++x)
          mean[static_cast<std::size_t>(100 * y + x)] += (image.gray(x + dx * s, y) - kBoard) / frames;
      }
    }
    double square = 0.0;
    for (const double value : mean) square += value * value / static_cast<double>(mean.size());
    EXPECT_NEAR(std::sqrt(square), sigma / std::sqrt(frames), 0.03 * sigma / std::sqrt(frames)) << dx;
  }
}

TEST(HardSpotCamera, NamesEveryFaultOfItsImperfections) {
  CameraDescription description = straight();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  description.bits = 16;
  description.texture = {
      .grain_gray = -1.0, .grain_length_mm = 0.0, .glow_share = 0.6, .glow_length_mm = nan};
  description.roughness = {.rms_mm = 1.0, .length_mm = 0.0};
  description.plume = {
      .share = 2.0, .offset_mm = {nan, 0.0}, .sigma_mm = 0.0, .flicker = -1.0, .wander_mm = -1.0};
  description.light = {.vignette = 1.0, .gradient_x = 0.8, .gradient_y = -0.8};
  description.hot = {.share = 0.5, .gray = 300.0};
  description.link = {.drop_share = 1.5, .stamp_jitter_s = 1.0, .late_share = nan, .late_s = -1.0};
  PrintLayout print = blank();
  print.areas = {{.p_SA_mm = {nan, 0.0}, .size_mm = {0.0, 1.0}, .ink = 2.0}};
  const std::string text = faultsOf(description) + faultsOf(print);
  for (const char* name : {"bits",
                           "grain_gray",
                           "grain_length_mm",
                           "glow_share",
                           "glow_length_mm",
                           "rms_mm",
                           "roughness.length_mm",
                           "plume.share",
                           "offset_mm",
                           "sigma_mm",
                           "flicker",
                           "wander_mm",
                           "vignette",
                           "gradient_x",
                           "hot.share",
                           "hot.gray",
                           "drop_share",
                           "stamp_jitter_s",
                           "late_share",
                           "late_s",
                           "areas",
                           "size_mm",
                           "ink"}) {
    EXPECT_NE(text.find(name), std::string::npos) << name << " in " << text;
  }
  EXPECT_EQ(faultsOf(hard()), "");
}

}  // namespace
}  // namespace kerfbench::twin
