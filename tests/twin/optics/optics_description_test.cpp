// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/optics_description.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A number of a description with values that are just valid and just not.
template <typename Description>
struct Field {
  std::string name;
  std::function<double&(Description&)> of;
  std::vector<double> good;
  std::vector<double> bad;
};

template <typename Description>
void expectEachFieldToBeChecked(const Description& fine, const std::vector<Field<Description>>& fields) {
  EXPECT_EQ(faultsOf(fine), "");
  for (const auto& field : fields) {
    Description description = fine;
    for (const double value : field.good) {
      field.of(description) = value;
      EXPECT_EQ(faultsOf(description), "") << field.name;
    }
    std::vector<double> bad = field.bad;
    bad.push_back(std::nan(""));
    bad.push_back(-kInfinity);
    for (const double value : bad) {
      field.of(description) = value;
      const std::string faults = faultsOf(description);
      EXPECT_THAT(faults, HasSubstr(field.name + " must be")) << value;
      EXPECT_THAT(faults, Not(HasSubstr("\n")));
    }
  }
}

TEST(FaultsOf, AHeadNamesEachNumberOutOfRange) {
  using Head = ScanHeadDescription;
  Head head;
  head.lens = LensDescription{.focal_length_mm = 500.0};
  expectEachFieldToBeChecked<Head>(
      head,
      {
          {"head.throw_mm",
           [](Head& h) -> double& { return h.throw_mm; },
           {1e-3, 1e5},
           {0, -1, 2e5, kInfinity}},
          {"head.mirror_spacing_mm",
           [](Head& h) -> double& { return h.mirror_spacing_mm; },
           {0, 1e4},
           {-1, 2e4}},
          {"head.x.axis_tilt_rad[0]", [](Head& h) -> double& { return h.x.axis_tilt_rad[0]; }, {0.1}, {0.11}},
          {"head.x.axis_tilt_rad[1]",
           [](Head& h) -> double& { return h.x.axis_tilt_rad[1]; },
           {-0.1},
           {-0.11}},
          {"head.y.axis_tilt_rad[1]", [](Head& h) -> double& { return h.y.axis_tilt_rad[1]; }, {0.1}, {0.11}},
          {"head.x.surface_offset_mm",
           [](Head& h) -> double& { return h.x.surface_offset_mm; },
           {-50, 50},
           {51}},
          {"head.y.zero_rad", [](Head& h) -> double& { return h.y.zero_rad; }, {-0.5, 0.5}, {0.6, -0.6}},
          {"head.y.scale",
           [](Head& h) -> double& { return h.y.scale; },
           {0.5, 2},
           {0, 0.4, 2.1, -1, kInfinity}},
          {"head.lens.focal_length_mm",
           [](Head& h) -> double& { return h.lens->focal_length_mm; },
           {1},
           {0, 2e5}},
          {"head.lens.decentre_mm[0]",
           [](Head& h) -> double& { return h.lens->decentre_mm[0]; },
           {-50},
           {51}},
          {"head.lens.tilt_rad[1]", [](Head& h) -> double& { return h.lens->tilt_rad[1]; }, {0.1}, {0.2}},
          {"head.lens.k1", [](Head& h) -> double& { return h.lens->k1; }, {10}, {11}},
          {"head.lens.k2", [](Head& h) -> double& { return h.lens->k2; }, {10}, {11}},
          {"head.lens.incidence_ratio",
           [](Head& h) -> double& { return h.lens->incidence_ratio; },
           {0, 1.5},
           {2}},
      });
}

TEST(FaultsOf, ALensMustNotFoldItsFieldBack) {
  ScanHeadDescription head;
  const auto faults = [&](double k1, double k2) {
    head.lens = LensDescription{.focal_length_mm = 500.0, .k1 = k1, .k2 = k2};
    return faultsOf(head);
  };
  // The condition is 1 + 3 k1 t² + 5 k2 t⁴ > 0 up to t² = 0.49.
  EXPECT_EQ(faults(-0.68, 0.0), "");
  EXPECT_THAT(faults(-0.681, 0.0), HasSubstr("grow with the field angle"));
  EXPECT_EQ(faults(-2.0, 1.9), "") << "it grows again before the end, and never shrank";
  EXPECT_THAT(faults(-2.0, 1.7), HasSubstr("grow with the field angle")) << "it shrinks on the way only";
}

TEST(FaultsOf, ABeamNamesEachNumberOutOfRange) {
  using Beam = BeamDescription;
  expectEachFieldToBeChecked<Beam>(
      {},
      {
          {"beam.waist_radius_mm",
           [](Beam& b) -> double& { return b.waist_radius_mm; },
           {1e-3, 100},
           {0, 101}},
          {"beam.rayleigh_mm", [](Beam& b) -> double& { return b.rayleigh_mm; }, {1e-3, kInfinity}, {0, -1}},
          {"beam.focus_z_mm", [](Beam& b) -> double& { return b.focus_z_mm; }, {-1e4, 1e4}, {2e4, kInfinity}},
          {"beam.offset_mm[0]", [](Beam& b) -> double& { return b.offset_mm[0]; }, {50}, {51}},
          {"beam.offset_mm[1]", [](Beam& b) -> double& { return b.offset_mm[1]; }, {-50}, {-51}},
          {"beam.tilt_rad[0]", [](Beam& b) -> double& { return b.tilt_rad[0]; }, {0.1}, {0.2}},
          {"beam.tilt_rad[1]", [](Beam& b) -> double& { return b.tilt_rad[1]; }, {-0.1}, {-0.2}},
      });
}

TEST(FaultsOf, ASurfaceNamesEachNumberOutOfRange) {
  using S = SurfaceDescription;
  expectEachFieldToBeChecked<S>(
      {},
      {
          {"surface.height_mm",
           [](S& s) -> double& { return s.height_mm; },
           {-1000, 1000},
           {1001, kInfinity}},
          {"surface.slope[0]", [](S& s) -> double& { return s.slope[0]; }, {0.1}, {0.11}},
          {"surface.slope[1]", [](S& s) -> double& { return s.slope[1]; }, {-0.1}, {-0.11}},
          {"surface.curvature_1_mm[0]", [](S& s) -> double& { return s.curvature_1_mm[0]; }, {0.01}, {0.02}},
          {"surface.curvature_1_mm[1]",
           [](S& s) -> double& { return s.curvature_1_mm[1]; },
           {-0.01},
           {-0.02}},
          {"surface.flutter_mm", [](S& s) -> double& { return s.flutter_mm; }, {0, 30}, {-1, 45, 51}},
          {"surface.flutter_hz", [](S& s) -> double& { return s.flutter_hz; }, {0, 1e5}, {-1, 2e5}},
          {"surface.flutter_wavelength_mm",
           [](S& s) -> double& { return s.flutter_wavelength_mm; },
           {1, kInfinity},
           {0, -1}},
          {"surface.flutter_phase_rad", [](S& s) -> double& { return s.flutter_phase_rad; }, {1e3}, {2e3}},
      });
}

TEST(FaultsOf, EverythingWrongIsListedAtOnce) {
  ScanHeadDescription head{.throw_mm = -1.0, .mirror_spacing_mm = -2.0};
  head.y.scale = 0.0;
  EXPECT_EQ(
      faultsOf(head),
      "head.throw_mm must be in (0, 100000], is -1; head.mirror_spacing_mm must be in [0, 10000], is -2; "
      "head.y.scale must be in [0.5, 2], is 0");
}

}  // namespace
}  // namespace kerfbench::twin
