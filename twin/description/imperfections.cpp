// SPDX-License-Identifier: Apache-2.0
#include "twin/description/imperfections.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <variant>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr std::uint64_t kImperfectionSeed = 0x696d706572666563ULL;

// FNV-1a: the stream of a quantity is its name, so that no list of numbers has to be kept.
constexpr std::uint64_t streamOf(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

class Drawing {
 public:
  Drawing(std::uint64_t seed, std::vector<Imperfection>& list)
      : seed_(seed ^ kImperfectionSeed), list_(list) {}

  void add(double& field, const std::string& name, double sigma, const char* unit) {
    change(field, sigma * normal(name), name, unit);
  }
  /// Adds an absolute value, where negative values are impossible.
  void addHalf(double& field, const std::string& name, double sigma, const char* unit) {
    change(field, std::abs(sigma * normal(name)), name, unit);
  }
  double relative(const std::string& name, double sigma) {
    const double share = sigma * normal(name);
    note(name, share, "relative");
    return 1.0 + share;
  }
  void addNoise(double& field, const std::string& name, double level, const char* unit) {
    change(field, std::hypot(field, level) - field, name, unit);
  }
  /// Adds another sine of the same frequency to amplitude sin(x + phase).
  void addSine(double& amplitude, double& phase_rad, const std::string& name, double sigma) {
    if (sigma == 0.0) return;
    const double in_phase = sigma * normal(name + "_cos");
    const double ahead = sigma * normal(name + "_sin");
    note(name + "_cos", in_phase, "mm");
    note(name + "_sin", ahead, "mm");
    const double x = amplitude * std::cos(phase_rad) + in_phase;
    const double y = amplitude * std::sin(phase_rad) + ahead;
    amplitude = std::hypot(x, y);
    phase_rad = std::atan2(y, x);
  }
  void change(double& field, double by, const std::string& name, const char* unit) {
    field += by;
    note(name, by, unit);
  }

 private:
  [[nodiscard]] double normal(std::string_view name) const {
    return CounterRandom(seed_, streamOf(name)).normal(0);
  }
  void note(const std::string& name, double value, const char* unit) {
    if (value != 0.0) list_.push_back({name, value, unit});
  }
  std::uint64_t seed_;
  std::vector<Imperfection>& list_;
};

void drawMirror(Drawing& draw, MirrorAlignment& mirror, const std::string& name,
                const ImperfectionSpread& spread) {
  draw.add(mirror.axis_tilt_rad[0], name + ".axis_tilt_1", spread.axis_tilt_rad, "rad");
  draw.add(mirror.axis_tilt_rad[1], name + ".axis_tilt_2", spread.axis_tilt_rad, "rad");
  draw.add(mirror.surface_offset_mm, name + ".surface_offset", spread.surface_offset_mm, "mm");
  draw.add(mirror.zero_rad, name + ".zero", spread.zero_rad, "rad");
  mirror.scale *= draw.relative(name + ".scale", spread.scale);
}

void drawHead(Drawing& draw, ScanHeadDescription& head, const ImperfectionSpread& spread) {
  drawMirror(draw, head.x, "galvo_x", spread);
  drawMirror(draw, head.y, "galvo_y", spread);
  draw.add(head.throw_mm, "head.throw", spread.throw_mm, "mm");
  draw.add(head.mirror_spacing_mm, "head.mirror_spacing", spread.mirror_spacing_mm, "mm");
  if (!head.lens) return;
  head.lens->focal_length_mm *= draw.relative("lens.focal_length", spread.focal_length);
  draw.add(head.lens->k1, "lens.k1", spread.lens_k1, "1/rad²");
  draw.add(head.lens->decentre_mm[0], "lens.decentre_x", spread.lens_decentre_mm, "mm");
  draw.add(head.lens->decentre_mm[1], "lens.decentre_y", spread.lens_decentre_mm, "mm");
  draw.add(head.lens->tilt_rad[0], "lens.tilt_x", spread.lens_tilt_rad, "rad");
  draw.add(head.lens->tilt_rad[1], "lens.tilt_y", spread.lens_tilt_rad, "rad");
}

// Changes the pitch of a lead screw or a toothed belt: the motor turns as commanded, the slide goes
// elsewhere.
void drawPitch(Drawing& draw, AxisDescription& axis, const std::string& name, double sigma) {
  const double factor = draw.relative(name + ".scale", sigma);
  axis.step *= factor;
  axis.load_per_motor *= factor;
}

// Changes the roller's radius. A larger roller carries more belt past for each count and for each pulse of
// the feed.
void drawRoller(Drawing& draw, BeltDescription& belt, double sigma) {
  const double factor = draw.relative("belt.roller_radius", sigma);
  belt.roller_radius_mm *= factor;
  belt.encoder.count_mm *= factor;
  belt.feed.step *= factor;
}

// A target that is too large makes what the camera sees seem too small.
void drawKerfCamera(Drawing& draw, CameraDescription& camera, const ImperfectionSpread& spread) {
  const double scale = draw.relative("kerf_camera.target_scale", spread.target_scale);
  camera.fx_px /= scale;
  camera.fy_px /= scale;
  camera.open_gray =
      std::min(255.0, camera.open_gray * draw.relative("kerf_camera.open_gray", spread.open_gray));
}

void drawStatic(Drawing& draw, MachineDescription& machine, const ImperfectionSpread& spread) {
  if (machine.kind == MachineDescription::Kind::kTwoMirror) {
    drawHead(draw, machine.head, spread);
  } else {
    drawPitch(draw, machine.gantry_x, "gantry_x", spread.scale);
    drawPitch(draw, machine.gantry_y, "gantry_y", spread.scale);
    draw.add(machine.squareness_rad, "gantry.squareness", spread.squareness_rad, "rad");
  }
  draw.add(machine.beam.offset_mm[0], "beam.offset_1", spread.beam_offset_mm, "mm");
  draw.add(machine.beam.offset_mm[1], "beam.offset_2", spread.beam_offset_mm, "mm");
  draw.add(machine.beam.tilt_rad[0], "beam.tilt_1", spread.beam_tilt_rad, "rad");
  draw.add(machine.beam.tilt_rad[1], "beam.tilt_2", spread.beam_tilt_rad, "rad");
  draw.add(machine.beam.focus_z_mm, "beam.focus_z", spread.focus_mm, "mm");
  draw.add(machine.surface.height_mm, "surface.height", spread.surface_height_mm, "mm");
  draw.add(machine.surface.slope[0], "surface.slope_x", spread.surface_slope, "mm/mm");
  draw.add(machine.surface.slope[1], "surface.slope_y", spread.surface_slope, "mm/mm");
  drawRoller(draw, machine.belt, spread.roller_radius);
  draw.add(machine.belt.print_mark_sensor.x_mm, "print_mark_sensor.x", spread.mark_sensor_mm, "mm");
  machine.laser.full_power_w *= draw.relative("laser.full_power", spread.power);
  machine.beam.waist_radius_mm *= draw.relative("beam.waist_radius", spread.beam_radius);
  machine.board_lot.thickness *= draw.relative("board.thickness", spread.board_thickness);
  machine.board_lot.transmission *= draw.relative("board.transmission", spread.board_transmission);
  machine.board_lot.cut_fluence *= draw.relative("board.cut_fluence", spread.board_cut_fluence);
  draw.addNoise(machine.board_lot.print_mm, "print.registration", spread.print_mm, "mm");
  draw.addNoise(machine.inspection_table.step_mm, "inspection_table.step", spread.table_step_mm, "mm");
  draw.add(machine.inspection_table.scale, "inspection_table.scale", spread.table_scale, "mm/mm");
  TableBow& bow_x = machine.inspection_table.bow_x;
  TableBow& bow_y = machine.inspection_table.bow_y;
  draw.addSine(bow_x.amplitude_mm, bow_x.phase_rad, "inspection_table.bow_x", spread.table_bow_mm);
  draw.addSine(bow_y.amplitude_mm, bow_y.phase_rad, "inspection_table.bow_y", spread.table_bow_mm);
  draw.add(machine.board_lot.swelling, "board.swelling", spread.swelling, "mm/mm");
  drawKerfCamera(draw, machine.kerf_camera, spread);
  machine.power_monitor.scale *= draw.relative("power_monitor.scale", spread.power_monitor_scale);
}

void drawBandwidth(Drawing& draw, DriveDescription& drive, const std::string& name, double sigma) {
  if (auto* const servo = std::get_if<ServoDescription>(&drive)) {
    servo->natural_frequency_rad_s *= draw.relative(name + ".bandwidth", sigma);
  }
}

void drawAxes(Drawing& draw, MachineDescription& machine, const ImperfectionSpread& spread) {
  const auto axis = [&](AxisDescription& description, const std::string& name, double backlash,
                        const char* unit) {
    drawBandwidth(draw, description.drive, name, spread.bandwidth);
    draw.addHalf(description.backlash, name + ".backlash", backlash, unit);
  };
  if (machine.kind == MachineDescription::Kind::kTwoMirror) {
    axis(machine.galvo_x, "galvo_x", spread.backlash_rad, "rad");
    axis(machine.galvo_y, "galvo_y", spread.backlash_rad, "rad");
  } else {
    axis(machine.gantry_x, "gantry_x", spread.backlash_mm, "mm");
    axis(machine.gantry_y, "gantry_y", spread.backlash_mm, "mm");
  }
  drawBandwidth(draw, machine.belt.feed.drive, "feed", spread.bandwidth);
  machine.belt.line_servo.natural_frequency_rad_s *= draw.relative("line.bandwidth", spread.bandwidth);
}

void drawSurface(Drawing& draw, SurfaceDescription& surface, const ImperfectionSpread& spread) {
  if (surface.flutter_mm == 0.0 && spread.flutter_mm > 0.0) {
    draw.change(surface.flutter_hz, spread.flutter_hz - surface.flutter_hz, "surface.flutter_frequency",
                "Hz");
  }
  draw.addSine(surface.flutter_mm, surface.flutter_phase_rad, "surface.flutter", spread.flutter_mm);
  draw.add(surface.curvature_1_mm[0], "surface.curl_x", spread.curl_1_mm, "1/mm");
  draw.add(surface.curvature_1_mm[1], "surface.curl_y", spread.curl_1_mm, "1/mm");
}

void drawDynamic(Drawing& draw, MachineDescription& machine, const ImperfectionSpread& spread) {
  drawAxes(draw, machine, spread);
  drawSurface(draw, machine.surface, spread);
  BeltDescription& belt = machine.belt;
  belt.sheet_friction *= draw.relative("belt.sheet_friction", spread.sheet_friction);
  draw.addNoise(belt.encoder.jitter_counts, "encoder.jitter", spread.encoder_jitter_counts, "counts");
  draw.addSine(belt.encoder.runout_mm, belt.encoder.runout_phase_rad, "encoder.runout",
               spread.encoder_runout_mm);
  draw.addNoise(belt.print_mark_sensor.jitter_mm, "print_mark_sensor.jitter", spread.mark_jitter_mm, "mm");
  draw.addNoise(machine.laser.noise, "laser.noise", spread.power_noise, "1");
  draw.add(machine.laser.drift, "laser.drift", spread.power_drift, "1");
  draw.addHalf(machine.laser.gate_delay_s, "laser.gate_delay", spread.gate_delay_s, "s");
}

}  // namespace

SampledMachine drawImperfections(const MachineDescription& machine, const ImperfectionSpread& spread,
                                 Preset preset, std::uint64_t seed) {
  SampledMachine sampled{machine, {}};
  Drawing draw(seed, sampled.imperfections);
  sampled.machine.board_lot.print_seed = seed;
  if (preset != Preset::kIdeal) drawStatic(draw, sampled.machine, spread);
  if (preset == Preset::kDynamic) drawDynamic(draw, sampled.machine, spread);
  return sampled;
}

PrintLayout printedOn(const BoardLot& lot, PrintLayout layout) {
  if (lot.print_mm == 0.0) return layout;
  const CounterRandom random(lot.print_seed ^ kImperfectionSeed, streamOf("print.marks"));
  std::uint64_t next = 0;
  for (RegistrationMark& mark : layout.marks) {
    mark.p_SM_mm.x() += lot.print_mm * random.normal(next++);
    mark.p_SM_mm.y() += lot.print_mm * random.normal(next++);
  }
  return layout;
}

}  // namespace kerfbench::twin
