// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <vector>

#include "hil/machine_file/machine_sections.h"
#include "twin/base/constants.h"

namespace kerfbench::machine_file {
namespace {

twin::EncoderDescription readEncoder(base::YamlReader encoder) {
  twin::EncoderDescription result;
  result.count_mm = encoder.number("count_mm", {.min = 1e-4, .max = 10});
  result.jitter_counts = encoder.number("jitter_counts", {.min = 0, .max = 0.2, .fallback = 0.0});
  result.runout_mm = encoder.number("runout_mm", {.min = 0, .max = 1, .fallback = 0.0});
  result.runout_phase_rad =
      kTurn_rad / 360.0 * encoder.number("runout_phase_deg", {.min = -360, .max = 360, .fallback = 0.0});
  return result;
}

twin::PrintMarkSensorDescription readPrintMarkSensor(base::YamlReader sensor) {
  twin::PrintMarkSensorDescription result;
  result.x_mm = sensor.number("x_mm", {.min = -1e4, .max = 1e4});
  result.jitter_mm = sensor.number("jitter_mm", {.min = 0, .max = 1, .fallback = 0.0});
  result.hysteresis_mm = sensor.number("hysteresis_mm", {.min = 0, .max = 2, .fallback = 0.0});
  return result;
}

void readSheet(base::YamlReader sheet, twin::BeltDescription& belt) {
  belt.sheet_mass_kg = sheet.number("mass_kg", {.min = 1e-3, .max = 100, .fallback = belt.sheet_mass_kg});
  belt.sheet_friction = sheet.number("friction", {.min = 0.01, .max = 20, .fallback = belt.sheet_friction});
  const auto drag = sheet.numbers("drag_n", 2, {.min = -100, .max = 100, .fallback = 0.0});
  belt.sheet_drag_n = {drag[0], drag[1]};
}

// Stiffness of the feet: by the frequency at which the frame swings on them, or as it is.
std::vector<double> readFeet(base::YamlReader& frame, double mass_kg) {
  const bool direct = frame.has("stiffness_n_mm");
  if (direct && frame.has("resonance_hz"))
    frame.fault("resonance_hz", "is given beside stiffness_n_mm: one of them is enough");
  auto values = direct ? frame.numbers("stiffness_n_mm", 2, {.min = 1, .max = 1e7})
                       : frame.numbers("resonance_hz", 2, {.min = 0.5, .max = 1000});
  for (double& value : values) value = direct ? kMetre_mm * value : mass_kg * std::pow(kTurn_rad * value, 2);
  return values;
}

}  // namespace

std::optional<twin::FrameDescription> readFrame(base::YamlReader& file) {
  if (!file.has("frame")) return std::nullopt;
  auto frame = file.section("frame");
  twin::FrameDescription result;
  result.mass_kg = frame.number("mass_kg", {.min = 1, .max = 1e5});
  const auto stiffness_n_m = readFeet(frame, result.mass_kg);
  const auto zeta = frame.numbers("damping", 2, {.min = 0, .max = 2, .fallback = 0.02});
  for (std::size_t axis = 0; axis < 2; ++axis) {
    result.stiffness_n_m.at(axis) = stiffness_n_m[axis];
    result.damping_n_s_m.at(axis) = 2.0 * zeta[axis] * std::sqrt(stiffness_n_m[axis] * result.mass_kg);
  }
  return result;
}

twin::BeltDescription readBelt(base::YamlReader belt, const DriveCatalogue& catalogue) {
  twin::BeltDescription result;
  result.roller_radius_mm = belt.number("roller_radius_mm", {.min = 1, .max = 1000});
  result.roller_inertia_kg_m2 = belt.number("roller_inertia_kg_m2", {.min = 1e-6, .max = 100});
  result.mass_kg = belt.number("mass_kg", {.min = 0.01, .max = 1e3});
  result.stiffness_n_m = kMetre_mm * belt.number("stiffness_n_mm", {.min = 0.1, .max = 1e6});
  result.damping_n_s_m = belt.number("damping_n_s_m", {.min = 0, .max = 1e6});
  result.bed_friction = readFriction(belt.section("bed_friction"), Load::kSlide);
  readSheet(belt.section("sheet"), result);
  result.encoder = readEncoder(belt.section("encoder"));
  result.print_mark_sensor = readPrintMarkSensor(belt.section("print_mark_sensor"));
  auto line = belt.section("line_drive");
  result.line_servo = readServo(line, nullptr, false).servo;
  if (belt.has("feed")) {
    result.feed = readAxis(belt.section("feed"), Load::kBelt, catalogue, result.roller_inertia_kg_m2,
                           result.roller_radius_mm);
  }
  return result;
}

}  // namespace kerfbench::machine_file
