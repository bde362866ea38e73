// SPDX-License-Identifier: Apache-2.0
// A window of the spot camera shows what the whole picture shows there, to the pixel.
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/camera/cameras.h"
#include "twin/base/image.h"
#include "twin/base/print_layout.h"
#include "twin/camera/camera.h"

namespace kerfbench::twin {
namespace {

struct Look {
  const char* name;
  void (*apply)(CameraDescription&);
};

PrintLayout marksAndAnArea() {
  PrintLayout print;
  print.units = 2;
  print.pitch_mm = 30.0;
  print.marks = {{{-5.0, -8.0}, 3.0}, {{4.0, 7.0}, 3.0}};
  print.areas = {{.p_SA_mm = {2.0, -3.0}, .size_mm = {9.0, 2.0}, .angle_rad = 0.3, .ink = 0.7}};
  return print;
}

Exposure exposure() {
  Exposure exposure{.sequence = 12, .start_s = 0.012, .samples = {}};
  for (int i = 0; i < 4; ++i) {
    exposure.samples.push_back({.p_WQ_mm = {1.0 + 0.1 * i, 2.0},
                                .radius_mm = 0.105,
                                .power_w = 30.0,
                                .p_WS_mm = {0.05 * i, 0.3},
                                .angle_rad = 0.002});
  }
  return exposure;
}

class SpotWindows : public testing::TestWithParam<Look> {};

TEST_P(SpotWindows, ShowWhatTheWholePictureShows) {
  CameraDescription description = cameraAbove(420, 331, 0.1);
  GetParam().apply(description);
  const SpotCamera camera(description, marksAndAnArea(), 4.0, 7);
  const GrayImage whole = camera.render(exposure()).image;
  // One around the spot, one that a mark is cut off by, a band, one that goes beyond the picture, one beside
  // it.
  const std::vector<PixelWindow> windows{
      {193, 117, 57, 61}, {140, 230, 41, 33}, {0, 70, 420, 40}, {390, 300, 80, 80}, {500, 10, 20, 20}};
  const Frame frame = camera.render(exposure(), windows);
  EXPECT_TRUE(frame.image.pixels.empty());
  EXPECT_EQ(frame.sequence, 12U);
  ASSERT_EQ(frame.windows.size(), windows.size());
  EXPECT_TRUE(frame.windows.back().pixels.empty());
  EXPECT_EQ(frame.windows[3].width, 30);
  EXPECT_EQ(frame.windows[3].height, 31);
  std::size_t compared = 0;
  for (const GrayImage& window : frame.windows) {
    for (int r = window.top; r <= window.bottom(); ++r) {
      for (int c = window.left; c <= window.right(); ++c, ++compared)
        ASSERT_EQ(window.gray(c, r), whole.gray(c, r)) << "column " << c << " row " << r;
    }
  }
  EXPECT_EQ(compared, 57U * 61U + 41U * 33U + 420U * 40U + 30U * 31U);
}

INSTANTIATE_TEST_SUITE_P(
    Pictures, SpotWindows,
    testing::Values(
        Look{"plain", [](CameraDescription&) {}}, Look{"ten_bits", [](CameraDescription& c) { c.bits = 10; }},
        Look{"grain_about_print",
             [](CameraDescription& c) { c.texture = {.grain_gray = 4.0, .grain_everywhere = false}; }},
        Look{"grain_everywhere", [](CameraDescription& c) { c.texture = {.grain_gray = 4.0}; }},
        Look{"glow_of_the_board", [](CameraDescription& c) { c.texture = {.glow_share = 0.2}; }},
        Look{"uneven_light",
             [](CameraDescription& c) {
               c.light = {.vignette = 0.3, .gradient_x = 0.2, .gradient_y = -0.1};
               c.texture = {.glow_share = 0.2};
             }},
        Look{"all_at_once",
             [](CameraDescription& c) {
               c.light = {.vignette = 0.3, .gradient_x = 0.2, .gradient_y = -0.1};
               c.texture = {.grain_gray = 4.0, .glow_share = 0.2};
               c.hot = {.share = 0.002};
               c.plume = {.share = 0.2, .offset_mm = {1.0, 0.0}, .flicker = 0.3, .wander_mm = 0.2};
             }},
        Look{"hot_pixels", [](CameraDescription& c) { c.hot = {.share = 0.002}; }}),
    [](const auto& look) { return look.param.name; });

}  // namespace
}  // namespace kerfbench::twin
