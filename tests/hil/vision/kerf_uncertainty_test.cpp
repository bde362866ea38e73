// SPDX-License-Identifier: Apache-2.0
// A caliper's stated error compared with the truth of the model, over good and hard pictures.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::vision {
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
    const int id = cut.add(dieline::LineCurve{middle - 1.8 * along, middle + 1.8 * along});
    cut.offset_mm[id] = 0.007 * ((i * 5) % 9 - 4);
  }
  cut.add(dieline::LineCurve{{-12.0, 0.0}, {12.0, 0.3}});
  cut.add(dieline::LineCurve{{-12.0, -10.0}, {12.0, -10.0}});
  cut.add(dieline::ArcCurve{{0.0, 10.5}, 1.5, 0.3, 2.0 * std::numbers::pi});
  cut.add(dieline::ArcCurve{{6.0, 10.5}, 2.0, 0.3, 4.5});
  return cut;
}

struct Hardness {
  std::string name;
  std::function<void(TwinCut&)> apply;
  double most_z{1.1};
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
      // Readings 0.35 mm apart share some of it, so their differences do not show all.
      {"coarse_grain", [](TwinCut& c) { c.camera.texture = {.grain_gray = 4.0, .grain_length_mm = 0.2}; },
       1.2},
      {"rough", [](TwinCut& c) { c.camera.roughness = {.rms_mm = 0.008, .length_mm = 0.06}; }},
      {"scorch",
       [](TwinCut& c) {
         c.board.scorch = {.fluence_j_mm2 = 0.15, .darkening = 0.3, .shift_mm = {0.06, 0.04}};
       }},
      {"blown_scorch",
       [](TwinCut& c) {
         c.board.scorch = {.fluence_j_mm2 = 0.1, .darkening = 0.3, .shift_mm = {-0.12, 0.05}};
       },
       1.2},
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
  EXPECT_LT(std::abs(h.bias_mm), 0.0006);
  // What other light and other walls would make of scorch is in it: more than the model's own does.
  EXPECT_GE(h.z, 0.6);
  EXPECT_LE(h.z, hard.most_z);
  EXPECT_GE(h.width_z, 0.65);
  EXPECT_LE(h.width_z, 1.7);
}
INSTANTIATE_TEST_SUITE_P(Pictures, CaliperSigma, testing::Range<std::size_t>(0, 13),
                         [](const auto& which) { return hardnesses()[which.param].name; });

/// Largest mean error of a line, over all directions.
double worstBias(const TwinCut& cut) {
  const KerfScan scan = cut.scan();
  double worst = 0.0;
  for (const EntityKerf& kerf : scan.entities) {
    const dieline::Curve& curve = cut.dieline.entities.at(static_cast<std::size_t>(kerf.entity)).curve;
    if (!std::holds_alternative<dieline::LineCurve>(curve)) continue;
    double sum = 0.0, count = 0.0;
    for (const Caliper& c : kerf.calipers) {
      if (!c.found || c.near_joint || c.station_mm < 0.3 ||
          c.station_mm > kerf.calipers.back().station_mm - 0.3)
        continue;
      const auto told = cut.offset_mm.find(kerf.entity);
      sum += c.offset_mm - cut.truth(scan, c, curve, told == cut.offset_mm.end() ? 0.0 : told->second);
      count += 1.0;
    }
    worst = std::max(worst, std::abs(sum / count));
  }
  return worst;
}

TEST(CaliperBias, IsSmallWhateverTheLightAndTheScorch) {
  struct Imperfection {
    const char* name;
    double most_mm;
    std::function<void(TwinCut&)> apply;
  };
  const auto scorch = [](double fluence, double darkening, double x, double y) {
    return [=](TwinCut& c) {
      c.board.scorch = {.fluence_j_mm2 = fluence, .darkening = darkening, .shift_mm = {x, y}};
    };
  };
  const std::vector<Imperfection> all{
      {"nothing", 0.0006, [](TwinCut&) {}},
      {"vignette of 40 %", 0.0006, [](TwinCut& c) { c.camera.light.vignette = 0.4; }},
      {"lamp falling off by 60 %", 0.0006, [](TwinCut& c) { c.camera.light.gradient_x = 0.6; }},
      {"even scorch", 0.0006, scorch(0.15, 0.3, 0.0, 0.0)},
      {"scorch blown 0.07 mm", 0.0010, scorch(0.15, 0.3, 0.06, 0.04)},
      {"scorch blown 0.13 mm", 0.0015, scorch(0.1, 0.3, -0.12, 0.05)},
      // Scorch that ends within the kerf's own flank leaves no visible trace outside of it.
      {"scorch in the flank alone", 0.0025, scorch(0.3, 0.15, 0.03, -0.05)},
      {"8 um rough edges", 0.0025, [](TwinCut& c) { c.camera.roughness.rms_mm = 0.008; }},
      {"grain", 0.0012, [](TwinCut& c) { c.camera.texture = {.grain_gray = 4.0, .grain_length_mm = 0.1}; }},
  };
  for (const Imperfection& imperfection : all) {
    TwinCut cut = workpiece();
    imperfection.apply(cut);
    const double worst = worstBias(cut);
    std::printf("  %-26s worst mean error of a line %.2f um\n", imperfection.name, 1e3 * worst);
    EXPECT_LT(worst, imperfection.most_mm) << imperfection.name;
  }
}

TEST(KerfUncertainty, ACreaseIsLeftOpenWhereItFadesOut) {
  TwinCut cut;
  const int crease = cut.add(dieline::LineCurve{{-10.0, 0.0}, {10.0, 1.0}}, dieline::Process::kCrease);
  const int line = cut.add(dieline::LineCurve{{-10.0, 5.0}, {10.0, 6.0}});
  cut.share_of[crease] = 0.0;
  // The laser was off over a stretch in its middle, too.
  const Vector2d along = Vector2d(20.0, 1.0).normalized();
  const Vector2d start(-10.0, 0.0);
  cut.also = [&](twin::Sheet& sheet) {
    cut.burn(sheet, start, start + 8.0 * along, 0.7);
    cut.burn(sheet, start + 10.0 * along, {10.0, 1.0}, 0.7);
  };
  const KerfScan scan = cut.scan();
  const std::vector<Caliper>& stations = test::entityOf(scan, crease).calipers;
  const double length_mm = stations.back().station_mm;
  std::size_t open = 0;
  for (const Caliper& c : stations) {
    double from_end_mm = std::min(c.station_mm, length_mm - c.station_mm);
    for (const double hole_mm : {8.0, 10.0})
      from_end_mm = std::min(from_end_mm, std::abs(c.station_mm - hole_mm));
    const bool hole = c.station_mm > 8.0 && c.station_mm < 10.0;
    if (hole || !c.found) continue;
    open += c.near_joint ? 1 : 0;
    if (from_end_mm < 0.05) {
      EXPECT_TRUE(c.near_joint) << c.station_mm;
    }
    if (from_end_mm > 0.4) {
      EXPECT_FALSE(c.near_joint) << c.station_mm;
    }
    if (!c.near_joint) {
      EXPECT_LT(std::abs(c.offset_mm), 0.005) << c.station_mm;
    }
  }
  EXPECT_GE(open, 4U);
  for (const Caliper& c : test::entityOf(scan, line).calipers)
    EXPECT_FALSE(c.near_joint) << "a cut has edges";
}

}  // namespace
}  // namespace kerfbench::vision
