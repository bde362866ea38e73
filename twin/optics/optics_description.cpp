// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/optics_description.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace kerfbench::twin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%g", value);
  return buffer.data();
}

// Collects values that are out of range; NaN is in no range.
class Faults {
 public:
  explicit Faults(std::string owner) : owner_(std::move(owner)) {}

  void within(const std::string& field, double value, double least, double most) {
    require(value >= least && value <= most,
            field + " must be in [" + text(least) + ", " + text(most) + "], is " + text(value));
  }
  void above0(const std::string& field, double value, double most) {
    require(value > 0 && value <= most, field + " must be in (0, " + text(most) + "], is " + text(value));
  }
  void within(const std::string& field, const std::array<double, 2>& pair, double most) {
    within(field + "[0]", pair[0], -most, most);
    within(field + "[1]", pair[1], -most, most);
  }
  void require(bool fine, const std::string& rule) {
    if (!fine) all_ += (all_.empty() ? "" : "; ") + owner_ + "." + rule;
  }
  [[nodiscard]] const std::string& all() const { return all_; }

 private:
  std::string owner_;
  std::string all_;
};

void check(Faults& faults, const std::string& name, const MirrorAlignment& mirror) {
  faults.within(name + ".axis_tilt_rad", mirror.axis_tilt_rad, 0.1);
  faults.within(name + ".surface_offset_mm", mirror.surface_offset_mm, -50.0, 50.0);
  faults.within(name + ".zero_rad", mirror.zero_rad, -0.5, 0.5);
  faults.within(name + ".scale", mirror.scale, 0.5, 2.0);
}

// Smallest slope of t (1 + k1 t² + k2 t⁴) for t up to the largest field angle.
double leastGrowth(const LensDescription& lens) {
  const double most = LensDescription::kMaxFieldAngle_rad * LensDescription::kMaxFieldAngle_rad;
  const auto growth = [&](double t2) { return 1.0 + t2 * (3.0 * lens.k1 + t2 * 5.0 * lens.k2); };
  const double turn = lens.k2 == 0 ? 0.0 : -0.3 * lens.k1 / lens.k2;
  return std::min({growth(0.0), growth(most), growth(std::clamp(turn, 0.0, most))});
}

void check(Faults& faults, const LensDescription& lens) {
  faults.above0("lens.focal_length_mm", lens.focal_length_mm, 1e5);
  faults.within("lens.k1", lens.k1, -10.0, 10.0);
  faults.within("lens.k2", lens.k2, -10.0, 10.0);
  faults.require(!(leastGrowth(lens) <= 0), "lens.k1, k2 must let the radius grow with the field angle");
  faults.within("lens.decentre_mm", lens.decentre_mm, 50.0);
  faults.within("lens.tilt_rad", lens.tilt_rad, 0.1);
  faults.within("lens.incidence_ratio", lens.incidence_ratio, -0.5, 1.5);
}

}  // namespace

std::string faultsOf(const ScanHeadDescription& head) {
  Faults faults("head");
  faults.above0("throw_mm", head.throw_mm, 1e5);
  faults.within("mirror_spacing_mm", head.mirror_spacing_mm, 0.0, 1e4);
  check(faults, "x", head.x);
  check(faults, "y", head.y);
  if (head.lens) check(faults, *head.lens);
  return faults.all();
}

std::string faultsOf(const BeamDescription& beam) {
  Faults faults("beam");
  faults.above0("waist_radius_mm", beam.waist_radius_mm, 100.0);
  faults.above0("rayleigh_mm", beam.rayleigh_mm, kInfinity);
  faults.within("focus_z_mm", beam.focus_z_mm, -1e4, 1e4);
  faults.within("offset_mm", beam.offset_mm, 50.0);
  faults.within("tilt_rad", beam.tilt_rad, 0.1);
  return faults.all();
}

std::string faultsOf(const SurfaceDescription& surface) {
  Faults faults("surface");
  faults.within("height_mm", surface.height_mm, -1000.0, 1000.0);
  faults.within("slope", surface.slope, 0.1);
  faults.within("curvature_1_mm", surface.curvature_1_mm, 0.01);
  faults.within("flutter_mm", surface.flutter_mm, 0.0, 50.0);
  faults.within("flutter_hz", surface.flutter_hz, 0.0, 1e5);
  faults.above0("flutter_wavelength_mm", surface.flutter_wavelength_mm, kInfinity);
  faults.require(
      !(2.0 * std::numbers::pi * surface.flutter_mm / std::abs(surface.flutter_wavelength_mm) > 0.5),
      "flutter_mm must be no more than wavelength / (4 pi)");
  faults.within("flutter_phase_rad", surface.flutter_phase_rad, -1e3, 1e3);
  return faults.all();
}

}  // namespace kerfbench::twin
