// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/inspect/verdict.h"
#include "hil/vision/kerf_scan.h"
#include "hil/vision/spot_track.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::hil {

struct Limits {
  double path_mm{0.05};
  double stillness_mm{0.05};
  double min_coverage{0.99};  ///< Share of stations with a kerf, per entity.
  double kerf_width_mm{
      0.05};             ///< Largest change of an entity's median width from the width usual for its process.
  double stray_mm{0.5};  ///< Longest stray cut allowed.
  double end_gap_mm{0.15};    ///< Longest piece left uncut at the start or the end of an entity.
  double passes{1.5};         ///< An entity along which the spot went more often than this was cut twice.
  double gate_tail_s{0.002};  ///< Longest time the spot may be seen outside the laser gate.
  double gate_lag_s{
      0.0005};  ///< Between the laser's gate and the instant at which the beam sets off, either way.
  double perforation_open_share{0};  ///< Tooth / (tooth + bridge) of a perforation as ordered; 0: not given.
  double perforation_share{0.10};    ///< Largest departure of the measured share from the ordered one.
};

/// An interval of the laser gate, as the pins showed it.
struct GateInterval {
  double on_s{};
  double off_s{};
};

/// Everything the verdict may rest on: pictures and pins, never the model.
struct Evidence {
  const Dieline* dieline{};
  PrintLayout print;
  SpotTrack spot;
  KerfScan kerf;
  std::vector<PulseTiming> pulses;
  std::vector<GateInterval> gates;
  /// Standard uncertainty of the offset that one caliper gives, and of one spot per axis, calibration
  /// included. There is no default: a measurement without a stated uncertainty makes the verdict INVALID.
  double kerf_u_mm{std::numeric_limits<double>::quiet_NaN()};
  double spot_u_mm{std::numeric_limits<double>::quiet_NaN()};
  double pin_u_s{
      0.0};  ///< Standard uncertainty of the time of one pin edge; 0 for an emulator, which counts cycles.
  std::vector<std::string>
      problems;  ///< Gaps, time limit, crash, protocol errors: each makes the verdict INVALID.
};

/// Deviation of one entity of one unit.
struct EntityResult {
  int unit{};
  int entity{};
  double worst_mm{};  ///< Signed offset of largest magnitude, away from joints; NaN if nothing was found.
  double worst_u{};   ///< Where, parameter of the curve.
  double rms_mm{};
  double
      coverage{};  ///< Share of stations burnt as the process asks, 0 … 1; of a perforation, the open share.
  double width_mm{};  ///< Median.
  double passes{};    ///< How often the spot went along it, from the spot camera: swept length / length.
};

/// Stillness of one cut (a run of frames with the spot alight).
struct CutResult {
  int unit{};
  int entity{};  ///< The entity it followed; -1 if none.
  double start_s{}, end_s{};
  int frames{};       ///< Frames whose path direction lets x be seen.
  double drift_mm{};  ///< Change of the x-residual over the cut, by least squares; NaN if it cannot be seen.
  double drift_sigma_mm{};
  double peak_mm{};
  double rms_mm{};
  std::vector<double> time_s{};       ///< For the report's plot.
  std::vector<double> residual_mm{};  ///< x-residual of spot against the dieline on the moving sheet.
};

struct InspectionResult {
  Verdict verdict{Verdict::kInvalid};
  std::vector<Check> checks;
  std::vector<EntityResult> entities;
  std::vector<CutResult> cuts;
  std::vector<std::string> problems;
};

/// Compares what was measured with the dieline. Pure: the same evidence gives the same result, to the bit.
/// Checks that do not apply (no crease: no depth check) are left out; so are those that make no sense of a
/// sheet on which nothing was cut, which the coverage check fails. Everything else that could not be measured
/// is INVALID.
InspectionResult inspect(const Evidence& evidence, const Limits& limits);

}  // namespace kerfbench::hil
