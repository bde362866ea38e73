// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/verdict/uncertainty.h"

namespace kerfbench::inspect {

/// Worst and RMS deviation of a set of lines.
struct DeviationEstimate {
  Quantity worst;  ///< Worst |deviation|.
  Quantity rms;
  double worst_as_read{};      ///< Largest |estimate|, before the correction for being an extreme.
  double worst_u_smoothing{};  ///< Standard uncertainty by what smoothing does to peaks; part of worst.U.
  double worst_hidden{};       ///< The most that the correction may fall short of; half of it is taken off.
  double worst_u_competing{};  ///< Standard uncertainty of the correction itself; part of worst.U.
  /// Standard uncertainty of the estimate at the worst place alone. The largest of places that compete
  /// scatters less than each of them, but whether they do is not known: worst.U is at least twice this. 0 for
  /// ErrorModel::trends.
  double worst_u_place{};
  std::size_t line{}, reading{};  ///< Where, in ErrorModel::lines.
  std::size_t caliper{};          ///< The reading's index in EntityKerf::calipers, for lines of a kerf.
};

/// Order of UncertaintyBudget::entries of DeviationResult::budget.
enum BudgetPart : std::uint8_t {
  kByNoise,
  kByPose,
  kByTable,
  kByCamera,
  kBySmoothing,
  kByCompeting,
  kByEstimator
};

struct DeviationResult {
  std::vector<DeviationEstimate> lines;  ///< One for each of ErrorModel::lines; NaN for one without readings.
  std::vector<std::string> layer_names;  ///< In order of first appearance.
  std::vector<DeviationEstimate> layers;
  DeviationEstimate all;
  std::vector<Quantity> circularity;  ///< Circularity of lines that are whole circles: range of radii about
                                      ///< the least-squares centre (ISO 230-4); NaN for others.
  std::vector<Quantity> widths;       ///< Kerf width of each line; filled for lines of a kerf.
  std::vector<double> width_own_U;    ///< U of the width without what the widths of all lines have in common.
  UncertaintyBudget budget;           ///< Budget of all.worst.
  double chance_beyond{};             ///< Chance that the truth of all.worst lies above the limit.
};

/// What a line of the model is.
struct LineKind {
  enum class Rms { kAboutZero, kAboutMean };
  std::string layer;
  Rms rms{Rms::kAboutZero};
  bool is_circle{};               ///< A whole circle.
  std::vector<double> angle_rad;  ///< Directions of a circle's readings from its centre.
  double window_rad{};            ///< Angle of a circle over which one reading is the mean.
};

/// Largest and RMS deviation with their uncertainty.
///
/// The readings of each line are smoothed (LineSmoother); the largest magnitude of the estimates is an
/// extreme of noisy values and so too large on average. By how much, and how far it scatters, is simulated: a
/// likely truth (the estimates, drawn in towards a smooth trend of the line until only the scatter is left
/// that noise does not explain) gets noise and shared errors drawn from the model and is measured in the same
/// way, 1000 times: the mean of what comes out corrects the value, twice its standard deviation is U. What
/// the likely truth itself still owes to noise is hidden from that; worst_hidden bounds it. The correction is
/// as large as places compete to be the worst, which one measurement does not show: it is taken as known to
/// within itself (rectangular, JCGM 100, 4.3.7). The budget finds both again without simulation
/// (extreme_budget.h). RMS is of the readings, less the square that their
/// uncertainty adds. The result is the same at any number of threads.
DeviationResult measureDeviations(const ErrorModel& model, const std::vector<LineKind>& kinds,
                                  double limit_mm, std::uint64_t seed, int threads = 1);

}  // namespace kerfbench::inspect
