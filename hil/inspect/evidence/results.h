// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/inspect/verdict/uncertainty.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::inspect {

/// Deviation of one entity of one unit.
struct EntityResult {
  int unit{};
  int entity{};
  double worst_mm{};    ///< Signed offset of largest magnitude, away from joints, corrected for being an
                        ///< extreme of noisy readings; NaN if nothing was found.
  double worst_U_mm{};  ///< Expanded uncertainty of its magnitude (k = 2), as all U here.
  double worst_u{};     ///< Where, parameter of the curve.
  double rms_mm{};      ///< RMS of the deviation, without what the readings' noise adds.
  double rms_U_mm{};
  double
      coverage{};  ///< Share of stations burnt as the process asks, 0 … 1; of a perforation, the open share.
  /// Longest piece that is not burnt, between the stations that coverage counts; 0: none. Of a perforation
  /// its longest bridge.
  double uncut_mm{};
  double width_mm{};  ///< Mean, without outliers.
  double width_U_mm{};
  double width_own_U_mm{};  ///< U of a comparison with the widths of other cuts: what they share is left out.
  double circularity_mm{};  ///< Circularity of a whole circle: range of radii about the least-squares centre
                            ///< (ISO 230-4).
  double circularity_U_mm{};
  double passes{};  ///< How often the spot went along it, from the spot camera: swept length / length.
};

/// One frame of a cut, for the report's plots.
struct CutFrame {
  double time_s{};
  int entity{-1};  ///< The line that the spot followed, or had left; -1: none.
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< The spot on the sheet of its unit.
  double deviation_mm{};  ///< Along the left normal of that line; NaN if it is lost or none.
  int program_line{};     ///< Line of the program that asks for this place; 0: not known.
};

/// Stillness of one cut (a run of frames with the spot alight).
struct CutResult {
  int unit{};
  int entity{};  ///< The entity it followed; -1 if none.
  double start_s{}, end_s{};
  int frames{};       ///< Frames whose path direction lets x be seen.
  int lost{};         ///< Frames that show the spot so far from its line that they tell no drift.
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
  std::vector<CutFrame> track{};      ///< All frames of the run, by time.
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
  int entity_out{};  ///< For a corner the entity that goes on; else the same.
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  bool at_start{};  ///< For an end: at the start of the entity.
  /// kCorner: how far the cut lies off the dieline there; kRounding, kOvershoot: how far off where its own
  /// legs would meet (CornerKerf). All >= 0. A gap is > 0, an overlap < 0. NaN if not found.
  Quantity mm;
  bool short_leg{};  ///< For a corner: CornerKerf::short_leg. Not judged.
};
/// "corner", "rounding", "overshoot", "end_gap", "closure"
std::string_view jointName(JointResult::Kind kind);

struct InspectionResult {
  Verdict verdict{Verdict::kInvalid};
  std::vector<Check> checks;       ///< Checks that were judged.
  std::vector<Unjudged> unjudged;  ///< All others, in the order of the report.
  std::vector<EntityResult> entities;
  std::vector<LayerResult> layers;
  std::vector<JointResult> joints;
  Quantity rms_mm;  ///< RMS of the deviation of all lines.
  std::vector<CutResult> cuts;
  std::vector<UncertaintyBudget> budgets;  ///< Budgets of the quantities that decide: path, stillness.
  std::vector<std::string> problems;
  /// With Tolerances::edge: the scan as read at the wanted piece's edge, which is what was judged.
  std::optional<vision::KerfScan> edges;
};

}  // namespace kerfbench::inspect
