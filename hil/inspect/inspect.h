// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/inspect/controller_account.h"
#include "hil/inspect/controller_end.h"
#include "hil/inspect/uncertainty.h"
#include "hil/inspect/verdict.h"
#include "hil/vision/camera_calibration.h"
#include "hil/vision/kerf_scan.h"
#include "hil/vision/spot_track.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::hil {

struct Limits {
  /// What must lie on the dieline: the kerf's centre, or the edge of the wanted piece, with the kerf outside
  /// of closed cuts, inside of them, or outside of outlines and inside of holes (closed cuts within an odd
  /// number of others). Open cuts and other processes have no such edge and are judged by their centre.
  enum class Edge { kCentre, kOutside, kInside, kNesting };
  Edge edge{Edge::kCentre};
  double path_mm{0.05};  ///< Of lines, corners and ends from the dieline.
  double stillness_mm{0.05};
  double min_coverage{0.99};   ///< Share of stations with a kerf, per entity.
  double kerf_width_mm{0.05};  ///< Largest change of an entity's width from the width usual for its process.
  double stray_mm{0.5};        ///< Longest stray cut allowed.
  double end_gap_mm{0.15};     ///< Longest piece left uncut at the start or the end of an entity.
  double passes{1.5};          ///< An entity along which the spot went more often than this was cut twice.
  double gate_tail_s{0.002};   ///< Longest time the spot may be seen outside the laser gate.
  double gate_lag_s{
      0.0005};  ///< Between the laser's gate and the instant at which the beam sets off, either way.
  double perforation_open_share{0};  ///< Tooth / (tooth + bridge) of a perforation as ordered; 0: not given.
  double perforation_share{0.10};    ///< Largest departure of the measured share from the ordered one.
  double even_depth_share{0};        ///< Largest change of depth along creases and half-cuts; 0: not judged.
  double board_transmission{0.12};   ///< Light through whole board, by which depth is told.
  double line_energy_j_mm{0};        ///< Laser energy per length that marks were to get; 0: not judged.
  double line_energy_share{0.0147};  ///< Largest departure from it (Wang, Li, Chen 2010).
};

/// An interval of the laser gate, as the pins showed it.
struct GateInterval {
  double on_s{};
  double off_s{};
};

/// An edge of the belt's encoder, as the pins showed it.
struct BeltEdge {
  double time_s{};
  double x_mm{};  ///< Of the belt since the start, by what the controller is told that a count is worth.
};

/// Everything the verdict may rest on: pictures and pins, never the model.
struct Evidence {
  const Dieline* dieline{};
  PrintLayout print;
  SpotTrack spot;
  KerfScan kerf;
  std::vector<PulseTiming> pulses;
  std::vector<GateInterval> gates;
  std::vector<BeltEdge> belt;                ///< By time; empty without an encoder, or if the belt stood.
  double belt_count_mm{};                    ///< Travel of one count.
  std::optional<ControllerAccount> account;  ///< None: nobody expects one (a recording, other firmware).
  std::optional<ControllerEnd> end;  ///< None: nobody heard the controller, or nobody knows its words.
  /// A power meter's pin: when it toggled, its delay taken off, and the energy that each edge stands for.
  std::vector<double> power_edges_s;
  double power_quantum_j{};
  /// With which the pictures were read. A camera without one, a reading outside its area and a reading
  /// without a stated uncertainty of its own each make the verdict INVALID.
  std::optional<CameraCalibration> kerf_calibration;
  std::optional<CameraCalibration> spot_calibration;
  double pin_u_s{
      0.0};  ///< Standard uncertainty of the time of one pin edge; 0 for an emulator, which counts cycles.
  /// How far the frames' times can be off on the clock of the pins, one and the same for all of them: of a
  /// real camera 99.7 % by a jackknife over its frames, plus the declared error of the light, so no strict
  /// bound; 0 where the camera is stamped by the pins' own clock.
  double clock_bound_s{0.0};
  std::vector<std::string>
      problems;  ///< Gaps, time limit, crash, protocol errors: each makes the verdict INVALID.
};

/// Deviation of one entity of one unit.
struct EntityResult {
  int unit{};
  int entity{};
  double worst_mm{};    ///< Signed offset of largest magnitude, away from joints, corrected for being an
                        ///< extreme of noisy readings; NaN if nothing was found.
  double worst_U_mm{};  ///< Expanded uncertainty of its magnitude (k = 2), as all U here.
  double worst_u{};     ///< Where, parameter of the curve.
  double rms_mm{};      ///< Of the deviation, without what the readings' noise adds.
  double rms_U_mm{};
  double
      coverage{};  ///< Share of stations burnt as the process asks, 0 … 1; of a perforation, the open share.
  double width_mm{};  ///< Mean, without outliers.
  double width_U_mm{};
  double width_own_U_mm{};  ///< Of a comparison with the widths of other cuts: what they share is left out.
  double circularity_mm{};  ///< Of a whole circle: range of radii about the least-squares centre (ISO 230-4).
  double circularity_U_mm{};
  double passes{};  ///< How often the spot went along it, from the spot camera: swept length / length.
};

/// Stillness of one cut (a run of frames with the spot alight).
struct CutResult {
  int unit{};
  int entity{};  ///< The entity it followed; -1 if none.
  double start_s{}, end_s{};
  int frames{};       ///< Frames whose path direction lets x be seen.
  double drift_mm{};  ///< Change of the x-residual over the cut, by least squares; NaN if it cannot be seen.
  double drift_sigma_mm{};
  double slope_mm_s{};  ///< drift_mm over the time from the first to the last of the frames.
  double slope_sigma_mm_s{};
  double offset_mm{};  ///< Mean of the x-residual: > 0, the spot runs ahead of its line on the sheet.
  double offset_sigma_mm{};
  double excursion_mm{};  ///< Largest |x-residual less its mean|, corrected for being an extreme.
  double excursion_U_mm{};
  double peak_mm{};  ///< Largest |x-residual|, corrected for being an extreme.
  double peak_U_mm{};
  double rms_mm{};  ///< About the mean, without what the frames' noise adds.
  double rms_U_mm{};
  /// Highest speed of the spot on the sheet, over 2 ms of way, as the crow flies: on a bend a little less
  /// than along it. NaN if there are fewer than two frames.
  double top_speed_mm_s{};
  double top_speed_U_mm_s{};
  std::vector<double> time_s{};       ///< For the report's plot.
  std::vector<double> residual_mm{};  ///< x-residual of spot against the dieline on the moving sheet.
  std::vector<double> sheet_x_mm{};   ///< x_W of the origin of the sheet's unit.
};

/// Deviation of all lines of one layer, all units together.
struct LayerResult {
  std::string layer;
  Quantity worst_mm;
  Quantity rms_mm;
};

/// A corner, an end of a line or where a closed line closes.
struct JointResult {
  enum class Kind { kCorner, kRounding, kOvershoot, kEndGap, kClosure };
  Kind kind{};
  int unit{};
  int entity{};
  int entity_out{};  ///< Of a corner: the entity that goes on; else the same.
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  bool at_start{};  ///< Of an end.
  /// kCorner: how far the cut lies off the dieline there; kRounding, kOvershoot: how far off where its own
  /// legs would meet (CornerKerf). All >= 0. A gap is > 0, an overlap < 0. NaN if not found.
  Quantity mm;
};
/// "corner", "rounding", "overshoot", "end_gap", "closure"
std::string_view jointName(JointResult::Kind kind);

struct InspectionResult {
  Verdict verdict{Verdict::kInvalid};
  std::vector<Check> checks;
  std::vector<EntityResult> entities;
  std::vector<LayerResult> layers;
  std::vector<JointResult> joints;
  Quantity rms_mm;  ///< Of the deviation of all lines.
  std::vector<CutResult> cuts;
  std::vector<UncertaintyBudget> budgets;  ///< Of the quantities that decide: path, stillness.
  std::vector<std::string> problems;
  /// With Limits::edge: the scan as read at the wanted piece's edge, which is what was judged.
  std::optional<KerfScan> edges;
};

/// Compares what was measured with the dieline. Pure: the same evidence gives the same result, to the bit.
/// Checks that do not apply (no crease: no depth check) are left out; so are those that make no sense of a
/// sheet on which nothing was cut, which the coverage check fails. Everything else that could not be measured
/// is INVALID. Of a controller that stopped by itself before its first cut, pins and words alone are judged.
InspectionResult inspect(const Evidence& evidence, const Limits& limits);

}  // namespace kerfbench::hil
