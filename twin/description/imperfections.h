// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "twin/description/description.h"

namespace kerfbench::twin {

/// How far a machine is from its drawing.
enum class Preset {
  kIdeal,    ///< As described.
  kStatic,   ///< Alignment, squareness, scale: what a set-up leaves behind and does not change any more.
  kDynamic,  ///< And lag, backlash, slip, flutter, noise, drift.
};

/// One value that a preset has changed.
struct Imperfection {
  std::string name;  ///< E.g. "galvo_x.zero".
  double value{};    ///< What was added to the description's value, or its relative change (unit "relative").
  std::string unit;
};

/// How large the imperfections of a machine are, all >= 0. A value is one standard deviation of a normal
/// distribution around what the description says; where one letter says so it is
///   h  half-normal: the absolute value of such a draw is added, since less than nothing cannot be;
///   v  a vector: two normal components of this standard deviation are added to amplitude and phase;
///   n  a level of noise, the same on every machine, which adds to the description's by the sum of squares.
/// The defaults are those of a machine that service has just set up.
struct ImperfectionSpread {
  // kStatic
  double axis_tilt_rad{20e-6};  ///< Tilt of each mirror axis, about each direction.
  double surface_offset_mm{
      0.003};             ///< Offset of each mirror; what is left when the origin of the field is taught.
  double zero_rad{5e-6};  ///< Zero of each mirror; 1 urad is 1 um at 500 mm.
  double scale{20e-6};    ///< Relative, of each mirror and gantry axis.
  double beam_offset_mm{0.005};  ///< In each direction; likewise.
  double beam_tilt_rad{20e-6};   ///< About each direction.
  double focus_mm{0.5};          ///< Height of the waist.
  double squareness_rad{20e-6};  ///< Squareness of the gantry.
  double surface_height_mm{0.01};
  double surface_slope{20e-6};        ///< In each direction.
  double roller_radius{20e-6};        ///< Relative: the scale of encoder and feed.
  double mark_sensor_mm{0.005};       ///< Place of the print-mark sensor.
  double power{0.01};                 ///< Relative, of the tube.
  double power_monitor_scale{0.005};  ///< Relative.
  // kDynamic
  double bandwidth{0.01};       ///< Relative, of each servo: its tracking delay.
  double backlash_rad{0.2e-6};  ///< h; of each mirror: the seat of a clamp, a galvo has no gear.
  double backlash_mm{0.002};    ///< h; of each gantry axis.
  double flutter_mm{0.01};      ///< v
  double flutter_hz{12.0};      ///< Not drawn: how fast a board flutters that rests in the description.
  double curl_1_mm{1e-6};       ///< In each direction.
  double sheet_friction{0.05};  ///< Relative, of the sheet on the belt: where it slips.
  double encoder_jitter_counts{0.03};  ///< n
  double encoder_runout_mm{0.002};     ///< v
  double mark_jitter_mm{0.002};        ///< n
  double power_noise{0.01};            ///< n; relative.
  double power_drift{0.01};            ///< Relative.
  double gate_delay_s{2e-6};           ///< h
  // kStatic as well, of a scan head that nobody has calibrated: none on a machine that is set up.
  double throw_mm{0.0};           ///< Last mirror to work plane.
  double mirror_spacing_mm{0.0};  ///< Between the mirrors' axes.
  double focal_length{0.0};       ///< Relative, of the lens, if there is one; so are the next.
  double lens_k1{0.0};            ///< Deviation from f theta, 1/rad².
  double lens_decentre_mm{0.0};   ///< In each direction.
  double lens_tilt_rad{0.0};      ///< About each direction.
};

struct SampledMachine {
  MachineDescription machine;
  std::vector<Imperfection> imperfections;  ///< All that were drawn, in a fixed order; empty for kIdeal.
};

/// Draws a machine around its description: a pure function of its arguments. What the controller is told
/// stays as it is. Each quantity has a random stream of its own, chosen by its name: a quantity or a machine
/// part that is added never changes what the others draw, and doubling a spread doubles its draws.
SampledMachine drawImperfections(const MachineDescription& machine, const ImperfectionSpread& spread,
                                 Preset preset, std::uint64_t seed);

}  // namespace kerfbench::twin
