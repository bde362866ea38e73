// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "hil/machine_file/machine_sections.h"
#include "twin/base/constants.h"

namespace kerfbench::machine_file {
namespace {

std::array<double, 2> pair(base::YamlReader& section, std::string_view key, double limit, double unit = 1.0) {
  const auto values = section.numbers(key, 2, {.min = -limit, .max = limit, .fallback = 0.0});
  return {unit * values[0], unit * values[1]};
}

twin::MirrorAlignment readAlignment(base::YamlReader mirror) {
  twin::MirrorAlignment result;
  result.axis_tilt_rad = pair(mirror, "axis_tilt_urad", 1e5, kMicro);
  result.surface_offset_mm = mirror.number("surface_offset_mm", {.min = -10, .max = 10, .fallback = 0.0});
  result.zero_rad = kMicro * mirror.number("zero_urad", {.min = -1e5, .max = 1e5, .fallback = 0.0});
  result.scale = mirror.number("scale", {.min = 0.9, .max = 1.1, .fallback = 1.0});
  return result;
}

twin::LensDescription readLens(base::YamlReader lens) {
  twin::LensDescription result;
  result.focal_length_mm = lens.number("focal_length_mm", {.min = 10, .max = 5000});
  result.k1 = lens.number("k1_1_rad2", {.min = -1, .max = 1, .fallback = 0.0});
  result.k2 = lens.number("k2_1_rad4", {.min = -1, .max = 1, .fallback = 0.0});
  result.decentre_mm = pair(lens, "decentre_mm", 10);
  result.tilt_rad = pair(lens, "tilt_urad", 1e5, kMicro);
  result.incidence_ratio =
      lens.number("incidence_ratio", {.min = 0, .max = 2, .fallback = result.incidence_ratio});
  return result;
}

}  // namespace

twin::ScanHeadDescription readHead(base::YamlReader optics) {
  twin::ScanHeadDescription head;
  head.throw_mm = optics.number("throw_mm", {.min = 10, .max = 5000});
  head.mirror_spacing_mm = optics.number("mirror_spacing_mm", {.min = 0, .max = 500});
  head.y_mirror_first = optics.choice("first_mirror", {"x", "y"}, "x") == "y";
  head.x = readAlignment(optics.section("mirror_x"));
  head.y = readAlignment(optics.section("mirror_y"));
  if (optics.has("lens")) head.lens = readLens(optics.section("lens"));
  return head;
}

twin::BeamDescription readBeam(base::YamlReader& beam) {
  twin::BeamDescription result;
  result.waist_radius_mm = beam.number("waist_radius_mm", {.min = 0.032, .max = 5});
  result.rayleigh_mm = beam.number("rayleigh_mm", {.min = 0.1, .max = 1e4, .fallback = result.rayleigh_mm});
  result.focus_z_mm = beam.number("focus_z_mm", {.min = -100, .max = 100, .fallback = 0.0});
  result.offset_mm = pair(beam, "offset_mm", 10);
  result.tilt_rad = pair(beam, "tilt_urad", 1e5, kMicro);
  return result;
}

twin::SurfaceDescription readSurface(base::YamlReader surface) {
  twin::SurfaceDescription result;
  result.height_mm = surface.number("height_mm", {.min = -10, .max = 10, .fallback = 0.0});
  result.slope = pair(surface, "slope_mrad", 100, kMilli);
  result.curvature_1_mm = pair(surface, "curl_1_m", 10, 1.0 / kMetre_mm);
  result.flutter_mm = surface.number("flutter_mm", {.min = 0, .max = 5, .fallback = 0.0});
  result.flutter_hz = surface.number("flutter_hz", {.min = 0, .max = 1000, .fallback = 0.0});
  result.flutter_wavelength_mm = surface.number(
      "flutter_wavelength_mm", {.min = 10, .max = 1e5, .fallback = result.flutter_wavelength_mm});
  result.flutter_phase_rad = std::numbers::pi / 180.0 *
                             surface.number("flutter_phase_deg", {.min = -360, .max = 360, .fallback = 0.0});
  return result;
}

}  // namespace kerfbench::machine_file
