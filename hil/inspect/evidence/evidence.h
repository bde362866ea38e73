// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/dieline/process.h"
#include "hil/inspect/evidence/pin_evidence.h"
#include "hil/inspect/verdict/controller_account.h"
#include "hil/inspect/verdict/controller_end.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "hil/vision/spot/spot_track.h"
#include "twin/base/print_layout.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::inspect {

/// Everything the verdict may rest on: pictures and pins, never the model.
struct Evidence {
  int threads{1};  ///< For the simulations of uncertainty; the result is the same at any number.
  const dieline::Dieline* dieline{};
  PrintLayout print;
  vision::SpotTrack spot;
  vision::KerfScan kerf;
  std::vector<PulseTiming> pulses;
  std::vector<GateInterval> gates;
  std::vector<Span> light;  ///< Spans in which gate and PWM let the laser emit; by time.
  /// Spans in which the interlock was open; absent: the pins do not show it.
  std::optional<std::vector<Span>> guard_open;
  std::vector<BeltEdge> belt;  ///< Edges by time; none without an encoder, or if the belt stood.
  double belt_count_mm{};      ///< Travel of one count.
  std::optional<ControllerAccount> account;  ///< Absent: see no_words.
  std::optional<ControllerEnd> end;          ///< Absent: see no_words.
  /// Why the controller's report is absent, in one sentence.
  std::string no_words{"The run has no controller that reports."};
  bool words_expected{};  ///< The controller of this job reports, so that an absent report is a gap.
  /// A power meter's pin: when it toggled, its delay taken off, and the energy that each edge stands for.
  std::vector<double> power_edges_s;
  double power_quantum_j{};
  /// With which the pictures were read. A camera without one, a reading outside its area and a reading
  /// without a stated uncertainty of its own each make the verdict INVALID.
  std::optional<vision::CameraCalibration> kerf_calibration;
  std::optional<vision::CameraCalibration> spot_calibration;
  /// 1/e² radius of the beam on the board, from the laser's data sheet, by which the severed edge is told
  /// from the light; 0: not known, and the edge is where half of the light comes through.
  double beam_radius_mm{0.0};
  /// Where a registration mark is printed, standard uncertainty per axis, on all units alike.
  double print_sigma_mm{0.0};
  double pin_u_s{
      0.0};  ///< Standard uncertainty of the time of one pin edge; 0 for an emulator, which counts cycles.
  /// How far the frames' times can be off on the clock of the pins, one and the same for all of them: of a
  /// real camera 99.7 % by a jackknife over its frames, plus the declared error of the light, so no strict
  /// bound; 0 where the camera is stamped by the pins' own clock.
  double clock_bound_s{0.0};
  std::vector<std::string>
      problems;  ///< Gaps, time limit, crash, protocol errors: each makes the verdict INVALID.
  /// The guard was opened or closed as the machine did not do it: INVALID as well, but for a laser that
  /// stayed on behind an open guard, whoever opened it.
  std::vector<std::string> guard_problems;
};

}  // namespace kerfbench::inspect
