// SPDX-License-Identifier: Apache-2.0
#include "hil/machine_file/machine_sections.h"

namespace kerfbench::machine_file {

twin::ImperfectionSpread readSpread(base::YamlReader section) {
  twin::ImperfectionSpread spread;
  const auto read = [&section](std::string_view key, double unit, double most, double& value) {
    value = unit * section.number(key, {.min = 0, .max = most, .fallback = value / unit});
  };
  read("axis_tilt_urad", kMicro, 1e4, spread.axis_tilt_rad);
  read("surface_offset_mm", 1.0, 2, spread.surface_offset_mm);
  read("zero_urad", kMicro, 1e4, spread.zero_rad);
  read("scale_ppm", kMicro, 1e4, spread.scale);
  read("beam_offset_mm", 1.0, 2, spread.beam_offset_mm);
  read("beam_tilt_urad", kMicro, 1e4, spread.beam_tilt_rad);
  read("focus_mm", 1.0, 20, spread.focus_mm);
  read("squareness_urad", kMicro, 1e4, spread.squareness_rad);
  read("surface_height_mm", 1.0, 2, spread.surface_height_mm);
  read("surface_slope_urad", kMicro, 1e4, spread.surface_slope);
  read("roller_radius_ppm", kMicro, 1e4, spread.roller_radius);
  read("mark_sensor_mm", 1.0, 2, spread.mark_sensor_mm);
  read("power_percent", kPercent, 20, spread.power);
  read("power_monitor_scale_percent", kPercent, 20, spread.power_monitor_scale);
  read("beam_radius_percent", kPercent, 20, spread.beam_radius);
  read("board_thickness_percent", kPercent, 20, spread.board_thickness);
  read("board_transmission_percent", kPercent, 20, spread.board_transmission);
  read("board_cut_fluence_percent", kPercent, 20, spread.board_cut_fluence);
  read("print_registration_um", 1e-3, 50, spread.print_mm);
  read("table_step_um", 1e-3, 50, spread.table_step_mm);
  read("table_scale_ppm", kMicro, 1e3, spread.table_scale);
  read("table_straightness_um", 1e-3, 50, spread.table_bow_mm);
  read("target_scale_ppm", kMicro, 1e3, spread.target_scale);
  read("board_swelling_ppm", kMicro, 1e3, spread.swelling);
  read("open_gray_percent", kPercent, 20, spread.open_gray);
  read("bandwidth_percent", kPercent, 20, spread.bandwidth);
  read("backlash_urad", kMicro, 1e4, spread.backlash_rad);
  read("backlash_mm", 1.0, 1, spread.backlash_mm);
  read("flutter_mm", 1.0, 2, spread.flutter_mm);
  read("flutter_hz", 1.0, 1000, spread.flutter_hz);
  read("curl_1_m", kMilli, 10, spread.curl_1_mm);
  read("sheet_friction_percent", kPercent, 20, spread.sheet_friction);
  read("encoder_jitter_counts", 1.0, 0.05, spread.encoder_jitter_counts);
  read("encoder_runout_mm", 1.0, 0.5, spread.encoder_runout_mm);
  read("mark_jitter_mm", 1.0, 0.5, spread.mark_jitter_mm);
  read("power_noise_percent", kPercent, 20, spread.power_noise);
  read("power_drift_percent", kPercent, 20, spread.power_drift);
  read("gate_delay_us", kMicro, 1e3, spread.gate_delay_s);
  read("throw_mm", 1.0, 50, spread.throw_mm);
  read("mirror_spacing_mm", 1.0, 5, spread.mirror_spacing_mm);
  read("focal_length_percent", kPercent, 5, spread.focal_length);
  read("lens_k1_1_rad2", 1.0, 0.1, spread.lens_k1);
  read("lens_decentre_mm", 1.0, 5, spread.lens_decentre_mm);
  read("lens_tilt_urad", kMicro, 2e4, spread.lens_tilt_rad);
  return spread;
}

}  // namespace kerfbench::machine_file
