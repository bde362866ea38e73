// SPDX-License-Identifier: Apache-2.0
#include "twin/description/imperfections.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

using Fields = std::map<std::string, double>;

void axisFields(Fields& all, const std::string& name, const AxisDescription& axis) {
  all[name + ".step"] = axis.step;
  all[name + ".load_per_motor"] = axis.load_per_motor;
  all[name + ".backlash"] = axis.backlash;
  all[name + ".stiffness"] = axis.stiffness;
  all[name + ".load_inertia"] = axis.load_inertia;
  if (const auto* servo = std::get_if<ServoDescription>(&axis.drive)) {
    all[name + ".bandwidth"] = servo->natural_frequency_rad_s;
    all[name + ".damping"] = servo->damping;
  }
}

void mirrorFields(Fields& all, const std::string& name, const MirrorAlignment& mirror) {
  all[name + ".axis_tilt_1"] = mirror.axis_tilt_rad[0];
  all[name + ".axis_tilt_2"] = mirror.axis_tilt_rad[1];
  all[name + ".surface_offset"] = mirror.surface_offset_mm;
  all[name + ".zero"] = mirror.zero_rad;
  all[name + ".scale"] = mirror.scale;
}

void opticsFields(Fields& all, const MachineDescription& m) {
  all["head.throw"] = m.head.throw_mm;
  all["head.spacing"] = m.head.mirror_spacing_mm;
  const LensDescription lens = m.head.lens.value_or(LensDescription{});
  all["lens.focal_length"] = lens.focal_length_mm;
  all["lens.k1"] = lens.k1;
  all["lens.k2"] = lens.k2;
  all["lens.decentre_x"] = lens.decentre_mm[0];
  all["lens.decentre_y"] = lens.decentre_mm[1];
  all["lens.tilt_x"] = lens.tilt_rad[0];
  all["lens.tilt_y"] = lens.tilt_rad[1];
  mirrorFields(all, "head.x", m.head.x);
  mirrorFields(all, "head.y", m.head.y);
  all["beam.offset_1"] = m.beam.offset_mm[0];
  all["beam.offset_2"] = m.beam.offset_mm[1];
  all["beam.tilt_1"] = m.beam.tilt_rad[0];
  all["beam.tilt_2"] = m.beam.tilt_rad[1];
  all["beam.focus"] = m.beam.focus_z_mm;
  all["beam.waist"] = m.beam.waist_radius_mm;
  all["surface.height"] = m.surface.height_mm;
  all["surface.slope_x"] = m.surface.slope[0];
  all["surface.slope_y"] = m.surface.slope[1];
  all["surface.curl_x"] = m.surface.curvature_1_mm[0];
  all["surface.curl_y"] = m.surface.curvature_1_mm[1];
  all["surface.flutter"] = m.surface.flutter_mm;
  all["surface.flutter_hz"] = m.surface.flutter_hz;
  all["surface.flutter_phase"] = m.surface.flutter_phase_rad;
}

void beltAndLaserFields(Fields& all, const MachineDescription& m) {
  all["belt.roller_radius"] = m.belt.roller_radius_mm;
  all["belt.sheet_friction"] = m.belt.sheet_friction;
  all["line.bandwidth"] = m.belt.line_servo.natural_frequency_rad_s;
  all["encoder.count"] = m.belt.encoder.count_mm;
  all["encoder.jitter"] = m.belt.encoder.jitter_counts;
  all["encoder.runout"] = m.belt.encoder.runout_mm;
  all["encoder.runout_phase"] = m.belt.encoder.runout_phase_rad;
  all["mark.x"] = m.belt.print_mark_sensor.x_mm;
  all["mark.jitter"] = m.belt.print_mark_sensor.jitter_mm;
  all["laser.full_power"] = m.laser.full_power_w;
  all["laser.noise"] = m.laser.noise;
  all["laser.drift"] = m.laser.drift;
  all["laser.gate_delay"] = m.laser.gate_delay_s;
  all["monitor.scale"] = m.power_monitor.scale;
  all["board.thickness"] = m.board_lot.thickness;
  all["board.transmission"] = m.board_lot.transmission;
  all["board.cut_fluence"] = m.board_lot.cut_fluence;
  all["print.registration"] = m.board_lot.print_mm;
  all["inspection_table.step"] = m.inspection_table.step_mm;
  all["inspection_table.scale"] = m.inspection_table.scale;
  all["inspection_table.bow_x"] = m.inspection_table.bow_x.amplitude_mm;
  all["inspection_table.bow_x_phase"] = m.inspection_table.bow_x.phase_rad;
  all["inspection_table.bow_y"] = m.inspection_table.bow_y.amplitude_mm;
  all["inspection_table.bow_y_phase"] = m.inspection_table.bow_y.phase_rad;
  all["board.swelling"] = m.board_lot.swelling;
  all["kerf_camera.fx"] = m.kerf_camera.fx_px;
  all["kerf_camera.fy"] = m.kerf_camera.fy_px;
  all["kerf_camera.open_gray"] = m.kerf_camera.open_gray;
}

void controllerFields(Fields& all, const ControllerDescription& c) {
  for (const auto& [name, value] : {std::pair("throw", c.throw_mm),
                                    {"spacing", c.mirror_spacing_mm},
                                    {"mirror_step", c.mirror_step_rad},
                                    {"gantry_step", c.gantry_step_mm},
                                    {"delay", c.tracking_delay_s},
                                    {"count", c.encoder_count_mm},
                                    {"mark", c.print_mark_sensor_x_mm},
                                    {"feed", c.feed_step_mm},
                                    {"power", c.full_power_w}}) {
    all[std::string("controller.") + name] = value;
  }
}

// Fields that a preset may change, and some that it may not.
Fields fieldsOf(const MachineDescription& m) {
  Fields all;
  axisFields(all, "galvo_x", m.galvo_x);
  axisFields(all, "galvo_y", m.galvo_y);
  axisFields(all, "gantry_x", m.gantry_x);
  axisFields(all, "gantry_y", m.gantry_y);
  axisFields(all, "feed", m.belt.feed);
  all["squareness"] = m.squareness_rad;
  opticsFields(all, m);
  beltAndLaserFields(all, m);
  controllerFields(all, m.controller);
  return all;
}

std::set<std::string> changed(const MachineDescription& before, const MachineDescription& after) {
  const Fields old_fields = fieldsOf(before);
  std::set<std::string> names;
  for (const auto& [name, value] : fieldsOf(after)) {
    if (value != old_fields.at(name)) names.insert(name);
  }
  return names;
}

constexpr auto kNone =
    std::bit_cast<ImperfectionSpread>(std::array<double, sizeof(ImperfectionSpread) / sizeof(double)>{});

/// Usual spread, with that of an uncalibrated head.
constexpr ImperfectionSpread kUncalibrated = [] {
  ImperfectionSpread spread;
  spread.throw_mm = 2.0;
  spread.mirror_spacing_mm = 0.5;
  spread.focal_length = 0.005;
  spread.lens_k1 = 0.005;
  spread.lens_decentre_mm = 0.5;
  spread.lens_tilt_rad = 2e-3;
  return spread;
}();

MachineDescription lensed() {
  MachineDescription machine = twoMirror();
  machine.head.lens = LensDescription{.focal_length_mm = 500.0};
  return machine;
}

using Member = double ImperfectionSpread::*;
struct Quantity {
  Member member;
  bool is_static;
  /// Fields that the quantity changes on a machine with mirrors, and below on one with a gantry.
  std::set<std::string> mirrors;
  std::set<std::string> gantry;
};

std::vector<Quantity> quantities() {
  using S = ImperfectionSpread;
  const auto both = [](Member member, bool is_static, const std::set<std::string>& names) {
    return Quantity{member, is_static, names, names};
  };
  return {
      {&S::axis_tilt_rad,
       true,
       {"head.x.axis_tilt_1", "head.x.axis_tilt_2", "head.y.axis_tilt_1", "head.y.axis_tilt_2"},
       {}},
      {&S::surface_offset_mm, true, {"head.x.surface_offset", "head.y.surface_offset"}, {}},
      {&S::zero_rad, true, {"head.x.zero", "head.y.zero"}, {}},
      {&S::scale,
       true,
       {"head.x.scale", "head.y.scale"},
       {"gantry_x.step", "gantry_x.load_per_motor", "gantry_y.step", "gantry_y.load_per_motor"}},
      both(&S::beam_offset_mm, true, {"beam.offset_1", "beam.offset_2"}),
      both(&S::beam_tilt_rad, true, {"beam.tilt_1", "beam.tilt_2"}),
      both(&S::focus_mm, true, {"beam.focus"}),
      {&S::squareness_rad, true, {}, {"squareness"}},
      both(&S::surface_height_mm, true, {"surface.height"}),
      both(&S::surface_slope, true, {"surface.slope_x", "surface.slope_y"}),
      both(&S::roller_radius, true, {"belt.roller_radius", "encoder.count", "feed.step"}),
      both(&S::mark_sensor_mm, true, {"mark.x"}),
      both(&S::power, true, {"laser.full_power"}),
      both(&S::power_monitor_scale, true, {"monitor.scale"}),
      both(&S::beam_radius, true, {"beam.waist"}),
      both(&S::board_thickness, true, {"board.thickness"}),
      both(&S::board_transmission, true, {"board.transmission"}),
      both(&S::board_cut_fluence, true, {"board.cut_fluence"}),
      both(&S::print_mm, true, {"print.registration"}),
      both(&S::table_step_mm, true, {"inspection_table.step"}),
      both(&S::table_scale, true, {"inspection_table.scale"}),
      both(&S::table_bow_mm, true,
           {"inspection_table.bow_x", "inspection_table.bow_x_phase", "inspection_table.bow_y",
            "inspection_table.bow_y_phase"}),
      both(&S::target_scale, true, {"kerf_camera.fx", "kerf_camera.fy"}),
      both(&S::swelling, true, {"board.swelling"}),
      both(&S::open_gray, true, {"kerf_camera.open_gray"}),
      {&S::bandwidth,
       false,
       {"galvo_x.bandwidth", "galvo_y.bandwidth", "feed.bandwidth", "line.bandwidth"},
       {"gantry_x.bandwidth", "gantry_y.bandwidth", "feed.bandwidth", "line.bandwidth"}},
      {&S::backlash_rad, false, {"galvo_x.backlash", "galvo_y.backlash"}, {}},
      {&S::backlash_mm, false, {}, {"gantry_x.backlash", "gantry_y.backlash"}},
      both(&S::flutter_mm, false, {"surface.flutter", "surface.flutter_phase"}),
      both(&S::curl_1_mm, false, {"surface.curl_x", "surface.curl_y"}),
      both(&S::sheet_friction, false, {"belt.sheet_friction"}),
      both(&S::encoder_jitter_counts, false, {"encoder.jitter"}),
      both(&S::encoder_runout_mm, false, {"encoder.runout", "encoder.runout_phase"}),
      both(&S::mark_jitter_mm, false, {"mark.jitter"}),
      both(&S::power_noise, false, {"laser.noise"}),
      both(&S::power_drift, false, {"laser.drift"}),
      both(&S::gate_delay_s, false, {"laser.gate_delay"}),
      {&S::throw_mm, true, {"head.throw"}, {}},
      {&S::mirror_spacing_mm, true, {"head.spacing"}, {}},
      {&S::focal_length, true, {"lens.focal_length"}, {}},
      {&S::lens_k1, true, {"lens.k1"}, {}},
      {&S::lens_decentre_mm, true, {"lens.decentre_x", "lens.decentre_y"}, {}},
      {&S::lens_tilt_rad, true, {"lens.tilt_x", "lens.tilt_y"}, {}},
  };
}

TEST(Imperfections, AnIdealMachineIsAsDescribed) {
  for (const auto& machine : {lensed(), gantry()}) {
    const SampledMachine drawn = drawImperfections(machine, {}, Preset::kIdeal, 7);
    EXPECT_TRUE(drawn.imperfections.empty());
    EXPECT_TRUE(changed(machine, drawn.machine).empty());
  }
}

TEST(Imperfections, TheTableOfThisTestKnowsEveryQuantityButTheFrequencyOfFlutter) {
  EXPECT_EQ(quantities().size() + 1, sizeof(ImperfectionSpread) / sizeof(double));
}

TEST(Imperfections, EveryFieldOfTheSpreadChangesItsOwnFieldsAndNoOthers) {
  for (const Quantity& q : quantities()) {
    ImperfectionSpread spread = kNone;
    spread.*q.member = kUncalibrated.*q.member;
    const auto of = [&](const MachineDescription& machine, Preset preset) {
      return changed(machine, drawImperfections(machine, spread, preset, 3).machine);
    };
    EXPECT_EQ(of(lensed(), Preset::kDynamic), q.mirrors);
    EXPECT_EQ(of(gantry(), Preset::kDynamic), q.gantry);
    EXPECT_EQ(of(lensed(), Preset::kStatic), q.is_static ? q.mirrors : std::set<std::string>{});
    EXPECT_EQ(of(gantry(), Preset::kStatic), q.is_static ? q.gantry : std::set<std::string>{});
  }
}

TEST(Imperfections, MarksLieAroundTheirPlacesAsFarAsThePlateMayPrintThem) {
  PrintLayout layout;
  for (int i = 0; i < 500; ++i) layout.marks.push_back({{10.0 * i, -3.0 * i}, 3.0});
  BoardLot lot;
  EXPECT_EQ(printedOn(lot, layout).marks[7].p_SM_mm, layout.marks[7].p_SM_mm);
  lot.print_mm = 0.002;
  lot.print_seed = 5;
  double squares = 0.0;
  const PrintLayout printed = printedOn(lot, layout);
  for (std::size_t i = 0; i < layout.marks.size(); ++i) {
    EXPECT_EQ(printed.marks[i].diameter_mm, 3.0);
    squares += (printed.marks[i].p_SM_mm - layout.marks[i].p_SM_mm).squaredNorm();
  }
  // The scatter of 1000 values is known to 2.2 %.
  EXPECT_NEAR(std::sqrt(squares / 1000.0), 0.002, 0.0002);
  EXPECT_EQ(printedOn(lot, layout).marks[7].p_SM_mm, printed.marks[7].p_SM_mm) << "the same seed";
  lot.print_seed = 6;
  EXPECT_NE(printedOn(lot, layout).marks[7].p_SM_mm, printed.marks[7].p_SM_mm) << "another lot";
}

TEST(Imperfections, TheStaticPresetNeverTouchesWhatMoves) {
  for (const auto& machine : {lensed(), gantry()}) {
    std::set<std::string> fixed;
    for (const Quantity& q : quantities()) {
      if (!q.is_static) continue;
      fixed.insert(q.mirrors.begin(), q.mirrors.end());
      fixed.insert(q.gantry.begin(), q.gantry.end());
    }
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      for (const auto& name :
           changed(machine, drawImperfections(machine, {}, Preset::kStatic, seed).machine)) {
        EXPECT_TRUE(fixed.contains(name)) << name;
      }
    }
  }
}

TEST(Imperfections, TheSameSeedIsTheSameMachineAndAnotherIsNot) {
  const auto machine = lensed();
  const auto draw = [&](std::uint64_t seed) {
    return fieldsOf(drawImperfections(machine, kUncalibrated, Preset::kDynamic, seed).machine);
  };
  EXPECT_EQ(draw(4), draw(4));
  const Fields four = draw(4);
  const Fields five = draw(5);
  for (const Quantity& q : quantities()) {
    // Levels of noise are the same on every machine.
    using S = ImperfectionSpread;
    if (q.member == &S::encoder_jitter_counts || q.member == &S::mark_jitter_mm ||
        q.member == &S::power_noise || q.member == &S::print_mm || q.member == &S::table_step_mm) {
      continue;
    }
    for (const auto& name : q.mirrors) EXPECT_NE(four.at(name), five.at(name)) << name;
  }
}

TEST(Imperfections, NoQuantityChangesWhatAnotherDraws) {
  const auto machine = gantry();
  const Fields all = fieldsOf(drawImperfections(machine, {}, Preset::kDynamic, 11).machine);
  const Fields fixed = fieldsOf(drawImperfections(machine, {}, Preset::kStatic, 11).machine);
  for (const Quantity& q : quantities()) {
    ImperfectionSpread spread = kNone;
    spread.*q.member = kUncalibrated.*q.member;
    const Fields alone = fieldsOf(drawImperfections(machine, spread, Preset::kDynamic, 11).machine);
    for (const auto& name : q.gantry) {
      EXPECT_EQ(alone.at(name), all.at(name)) << name;
      EXPECT_TRUE(!q.is_static || fixed.at(name) == all.at(name)) << name;
    }
  }
}

TEST(Imperfections, TheListNamesEachDrawOnceWithItsUnitAndWhatItAdded) {
  for (const auto& machine : {lensed(), gantry()}) {
    const SampledMachine drawn = drawImperfections(machine, {}, Preset::kDynamic, 2);
    std::map<std::string, Imperfection> list;
    for (const Imperfection& i : drawn.imperfections) {
      EXPECT_TRUE(list.emplace(i.name, i).second) << i.name;
      EXPECT_FALSE(i.unit.empty());
      EXPECT_NE(i.value, 0.0);
    }
    EXPECT_NEAR(drawn.machine.surface.height_mm, list.at("surface.height").value, 1e-15);
    EXPECT_EQ(list.at("surface.height").unit, "mm");
    EXPECT_NEAR(drawn.machine.laser.full_power_w,
                machine.laser.full_power_w * (1.0 + list.at("laser.full_power").value), 1e-12);
    EXPECT_EQ(list.at("laser.full_power").unit, "relative");
    EXPECT_NEAR(drawn.machine.laser.noise, list.at("laser.noise").value, 1e-15);
    EXPECT_EQ(drawn.machine.surface.flutter_hz, ImperfectionSpread{}.flutter_hz);
    EXPECT_EQ(list.at("surface.flutter_frequency").unit, "Hz");
    EXPECT_NEAR(drawn.machine.surface.flutter_mm,
                std::hypot(list.at("surface.flutter_cos").value, list.at("surface.flutter_sin").value),
                1e-15);
    EXPECT_EQ(list.contains("galvo_x.zero"), machine.kind == MachineDescription::Kind::kTwoMirror);
    EXPECT_EQ(list.contains("gantry.squareness"), machine.kind == MachineDescription::Kind::kGantry);
  }
}

struct Moments {
  double mean{}, sigma{};
};

Moments over2000(const MachineDescription& machine,
                 const std::function<double(const MachineDescription&)>& of) {
  constexpr int kSeeds = 2000;
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const double value = of(drawImperfections(machine, {}, Preset::kDynamic, seed).machine);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kSeeds;
  return {mean, std::sqrt(squares / kSeeds - mean * mean)};
}

void expectNormal(const Moments& moments, double sigma, const char* what) {
  EXPECT_NEAR(moments.mean, 0.0, 4.0 * sigma / std::sqrt(2000.0)) << what;
  EXPECT_NEAR(moments.sigma, sigma, 4.0 * sigma / std::sqrt(4000.0)) << what;
}

TEST(Imperfections, DrawsHaveTheStandardDeviationOfTheSpread) {
  const MachineDescription mirrors = lensed();
  const MachineDescription strip = gantry();
  const ImperfectionSpread s;
  using M = const MachineDescription&;
  expectNormal(over2000(mirrors, [](M m) { return m.head.x.axis_tilt_rad[1]; }), s.axis_tilt_rad, "tilt");
  expectNormal(over2000(mirrors, [](M m) { return m.head.y.zero_rad; }), s.zero_rad, "zero");
  expectNormal(over2000(mirrors, [](M m) { return m.head.y.scale - 1.0; }), s.scale, "scale");
  expectNormal(over2000(mirrors, [](M m) { return m.head.x.surface_offset_mm; }), s.surface_offset_mm,
               "offset");
  expectNormal(over2000(strip, [](M m) { return m.squareness_rad; }), s.squareness_rad, "squareness");
  expectNormal(over2000(strip, [&](M m) { return m.gantry_x.step / strip.gantry_x.step - 1.0; }), s.scale,
               "pitch");
  expectNormal(over2000(strip, [&](M m) { return m.laser.full_power_w / strip.laser.full_power_w - 1.0; }),
               s.power, "power");
  expectNormal(over2000(strip, [](M m) { return m.surface.curvature_1_mm[0]; }), s.curl_1_mm, "curl");
  expectNormal(over2000(strip, [](M m) { return m.laser.drift; }), s.power_drift, "drift");
  expectNormal(
      over2000(strip,
               [](M m) { return m.belt.encoder.runout_mm * std::cos(m.belt.encoder.runout_phase_rad); }),
      s.encoder_runout_mm, "runout");
}

TEST(Imperfections, WhatCannotBeLessThanNothingIsHalfNormal) {
  const double to_mean = std::sqrt(2.0 / std::numbers::pi);
  const auto check = [&](const Moments& moments, double sigma, const char* what) {
    EXPECT_NEAR(moments.mean, to_mean * sigma, 4.0 * 0.6 * sigma / std::sqrt(2000.0)) << what;
    EXPECT_NEAR(moments.sigma, sigma * std::sqrt(1.0 - to_mean * to_mean), 0.06 * sigma) << what;
  };
  using M = const MachineDescription&;
  const ImperfectionSpread s;
  const MachineDescription mirrors = lensed();
  const double already = mirrors.galvo_x.backlash;
  check(over2000(mirrors, [&](M m) { return m.galvo_x.backlash - already; }), s.backlash_rad, "backlash");
  check(over2000(mirrors, [&](M m) { return m.laser.gate_delay_s - mirrors.laser.gate_delay_s; }),
        s.gate_delay_s, "gate delay");
}

TEST(Imperfections, NoiseAndSinesAddToThoseOfTheDescriptionAsTheyDoOnTheMachine) {
  MachineDescription machine = lensed();
  machine.laser.noise = 0.03;
  machine.belt.encoder.runout_mm = 0.1;
  machine.belt.encoder.runout_phase_rad = 1.0;
  machine.surface.flutter_mm = 0.2;
  machine.surface.flutter_hz = 5.0;
  ImperfectionSpread spread;
  spread.power_noise = 0.04;
  const MachineDescription drawn = drawImperfections(machine, spread, Preset::kDynamic, 1).machine;
  EXPECT_NEAR(drawn.laser.noise, 0.05, 1e-15);
  EXPECT_NEAR(drawn.belt.encoder.runout_mm, 0.1, 5.0 * spread.encoder_runout_mm);
  EXPECT_NEAR(drawn.belt.encoder.runout_phase_rad, 1.0, 0.1);
  EXPECT_EQ(drawn.surface.flutter_hz, 5.0);
}

}  // namespace
}  // namespace kerfbench::twin
