// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "twin/description/description.h"

namespace kerfbench::twin {

/// Kinds of deviation of a machine from its description.
enum class Preset {
  kIdeal,    ///< The machine as described.
  kStatic,   ///< Alignment, squareness, scale: errors that a set-up leaves behind and that stay constant.
  kDynamic,  ///< Errors of kStatic, with lag, backlash, slip, flutter, noise and drift.
};

/// One value that a preset has changed.
struct Imperfection {
  std::string name;  ///< Name of the quantity, e.g. "galvo_x.zero".
  double value{};    ///< Change of the description's value, absolute or relative (unit "relative").
  std::string unit;
};

/// Sizes of a machine's imperfections, all >= 0. A value is one standard deviation of a normal distribution
/// around the description's value, except where a letter says so:
///   h  half-normal: the absolute value of a sample is added, since negative values are impossible;
///   v  a vector: two normal components of this standard deviation are added to amplitude and phase;
///   n  a level of noise, the same on every machine, which adds to the description's by the sum of squares.
/// The defaults are those of a machine that service has just set up.
struct ImperfectionSpread {
  // kStatic
  double axis_tilt_rad{20e-6};  ///< Tilt of each mirror axis, about each direction.
  /// Offset of each mirror that remains when the origin of the field is taught.
  double surface_offset_mm{0.003};
  double zero_rad{5e-6};  ///< Zero of each mirror; 1 urad is 1 um at 500 mm.
  double scale{20e-6};    ///< Relative scale of each mirror and gantry axis.
  /// Offset of the beam in each direction that remains when the origin is taught.
  double beam_offset_mm{0.005};
  double beam_tilt_rad{20e-6};   ///< Tilt of the beam about each direction.
  double focus_mm{0.5};          ///< Height of the waist.
  double squareness_rad{20e-6};  ///< Squareness of the gantry.
  double surface_height_mm{0.01};
  double surface_slope{20e-6};        ///< Slope of the surface in each direction.
  double roller_radius{20e-6};        ///< Relative radius of the roller: the scale of encoder and feed.
  double mark_sensor_mm{0.005};       ///< Place of the print-mark sensor.
  double power{0.01};                 ///< Relative power of the tube.
  double power_monitor_scale{0.005};  ///< Relative scale of the power monitor.
  double beam_radius{0.03};           ///< Relative radius of the beam's waist.
  double board_thickness{0.025};      ///< Relative: cartonboard is sold as ±5 %.
  double board_transmission{0.05};    ///< Relative.
  double board_cut_fluence{0.03};     ///< Relative energy that cuts through.
  double print_mm{0.002};             ///< n: where the plate prints each registration mark.
  double table_step_mm{0.002};        ///< n: where the inspection table stops.
  double table_scale{10e-6};          ///< Relative scale of the inspection table.
  double table_bow_mm{0.002};         ///< v: by which each axis of it bows to the side, RMS.
  double target_scale{10e-6};  ///< Relative scale of the target that the kerf camera was calibrated with.
  double swelling{10e-6};      ///< Relative growth of the board between cut and inspection.
  double open_gray{0.02};      ///< Relative brightness of the back light.
  // kDynamic
  double bandwidth{0.01};       ///< Relative bandwidth of each servo: its tracking delay.
  double backlash_rad{0.2e-6};  ///< h: backlash of each mirror, in the seat of a clamp; a galvo has no gear.
  double backlash_mm{0.002};    ///< h: backlash of each gantry axis.
  double flutter_mm{0.01};      ///< v: amplitude of the flutter.
  double flutter_hz{12.0};  ///< Not sampled: flutter frequency of a board whose description has no flutter.
  double curl_1_mm{1e-6};   ///< Curl in each direction.
  double sheet_friction{0.05};  ///< Relative friction of the sheet on the belt; decides where it slips.
  double encoder_jitter_counts{0.03};  ///< n: jitter of the encoder's edges.
  double encoder_runout_mm{0.002};     ///< v: runout of the encoder.
  double mark_jitter_mm{0.002};        ///< n: jitter of the print-mark sensor.
  double power_noise{0.01};            ///< n: relative noise of the power.
  double power_drift{0.01};            ///< Relative drift of the power.
  double gate_delay_s{2e-6};           ///< h: delay of the gate.
  // kStatic as well: errors of an uncalibrated scan head; zero on a machine that is set up.
  double throw_mm{0.0};           ///< Distance from last mirror to work plane.
  double mirror_spacing_mm{0.0};  ///< Distance between the mirrors' axes.
  double focal_length{0.0};       ///< Relative focal length of the lens, if there is one.
  double lens_k1{0.0};            ///< Deviation from f theta, 1/rad².
  double lens_decentre_mm{0.0};   ///< Decentring of the lens in each direction.
  double lens_tilt_rad{0.0};      ///< Tilt of the lens about each direction.
};

struct SampledMachine {
  MachineDescription machine;
  std::vector<Imperfection> imperfections;  ///< All sampled values, in a fixed order; empty for kIdeal.
};

/// Samples a machine around its description: a pure function of its arguments. The controller's configuration
/// stays as it is. Each quantity has a random stream of its own, chosen by its name: adding a quantity or a
/// machine part never changes the samples of the others, and doubling a spread doubles its deviations.
SampledMachine drawImperfections(const MachineDescription& machine, const ImperfectionSpread& spread,
                                 Preset preset, std::uint64_t seed);

/// The layout as the lot of board bears it: its registration marks lie where they were printed.
PrintLayout printedOn(const BoardLot& lot, PrintLayout layout);

}  // namespace kerfbench::twin
