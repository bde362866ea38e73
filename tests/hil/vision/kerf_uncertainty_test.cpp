// SPDX-License-Identifier: Apache-2.0
// What a caliper says of its own error, against the truth of the model, over good and hard pictures.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::hil {
namespace {

using Eigen::Vector2d;
using test::TwinCut;

/// Lines in sixteen directions and a few arcs, each with an offset of its own.
TwinCut workpiece() {
  TwinCut cut;
  for (int i = 0; i < 16; ++i) {
    const double angle = i * std::numbers::pi / 16.0 + (i % 4 == 0 ? 0.0 : 0.03);
    const Vector2d along(std::cos(angle), std::sin(angle));
    const Vector2d middle(-14.0 + 4.0 * (i % 8), i < 8 ? 4.5 : -4.5);
    const int id = cut.add(LineCurve{middle - 1.8 * along, middle + 1.8 * along});
    cut.offset_mm[id] = 0.007 * ((i * 5) % 9 - 4);
  }
  cut.add(LineCurve{{-12.0, 0.0}, {12.0, 0.3}});
  cut.add(LineCurve{{-12.0, -10.0}, {12.0, -10.0}});
  cut.add(ArcCurve{{0.0, 10.5}, 1.5, 0.3, 2.0 * std::numbers::pi});
  cut.add(ArcCurve{{6.0, 10.5}, 2.0, 0.3, 4.5});
  return cut;
}

struct Hardness {
  std::string name;
  std::function<void(TwinCut&)> apply;
};

const std::vector<Hardness>& hardnesses() {
  static const std::vector<Hardness> all{
      {"clean", [](TwinCut&) {}},
      {"ten_bits", [](TwinCut& c) { c.camera.bits = 10; }},
      {"twelve_bits_low_noise",
       [](TwinCut& c) {
         c.camera.bits = 12;
         c.camera.read_noise = 0.2;
         c.camera.full_well_electrons = 30000;
       }},
      {"noisy", [](TwinCut& c) { c.camera.read_noise = 2.5; }},
      {"uneven_light",
       [](TwinCut& c) { c.camera.light = {.vignette = 0.4, .gradient_x = 0.3, .gradient_y = -0.2}; }},
      {"grain", [](TwinCut& c) { c.camera.texture = {.grain_gray = 4.0, .grain_length_mm = 0.1}; }},
      {"rough", [](TwinCut& c) { c.camera.roughness = {.rms_mm = 0.008, .length_mm = 0.06}; }},
      {"scorch",
       [](TwinCut& c) {
         c.board.scorch = {.fluence_j_mm2 = 0.15, .darkening = 0.3, .shift_mm = {0.06, 0.04}};
       }},
      {"blown_scorch",
       [](TwinCut& c) {
         c.board.scorch = {.fluence_j_mm2 = 0.1, .darkening = 0.3, .shift_mm = {-0.12, 0.05}};
       }},
      {"faint_scorch",
       [](TwinCut& c) {
         c.board.scorch = {.fluence_j_mm2 = 0.3, .darkening = 0.15, .shift_mm = {0.03, -0.05}};
       }},
      {"everything",
       [](TwinCut& c) {
         c.camera.bits = 10;
         c.camera.light = {.vignette = 0.3, .gradient_x = 0.2};
         c.camera.texture = {.grain_gray = 3.0, .grain_length_mm = 0.08};
         c.camera.roughness = {.rms_mm = 0.005, .length_mm = 0.06};
         c.camera.hot = {.share = 1e-5};
         c.board.scorch = {.fluence_j_mm2 = 0.15, .darkening = 0.2, .shift_mm = {-0.05, 0.03}};
       }},
      {"wide", [](TwinCut& c) { c.fluence_share = 4.0; }},
      {"thirty_um", [](TwinCut& c) { c.camera = test::kerfCamera(0.03, 1.34); }},
  };
  return all;
}

class CaliperSigma : public testing::TestWithParam<std::size_t> {};

TEST_P(CaliperSigma, IsHonest) {
  const Hardness& hard = hardnesses()[GetParam()];
  test::Errors errors;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    TwinCut cut = workpiece();
    hard.apply(cut);
    cut.seed = cut.camera.board_seed = seed;
    const KerfScan scan = cut.scan();
    ASSERT_TRUE(scan.problems.empty()) << scan.problems.front();
    errors.add(cut, scan);
  }
  const test::Honesty h = errors.honesty();
  std::printf("  %-22s n %zu bias %6.3f sigma %6.3f stated %6.3f um  z %.3f width z %.3f\n",
              hard.name.c_str(), h.count, 1e3 * h.bias_mm, 1e3 * h.sigma_mm, 1e3 * h.stated_mm, h.z,
              h.width_z);
  EXPECT_GE(h.z, 0.9);
  EXPECT_LE(h.z, 1.1);
}
INSTANTIATE_TEST_SUITE_P(Pictures, CaliperSigma, testing::Range<std::size_t>(0, 13),
                         [](const auto& which) { return hardnesses()[which.param].name; });

}  // namespace
}  // namespace kerfbench::hil
