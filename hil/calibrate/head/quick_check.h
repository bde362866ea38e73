// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/observation.h"

namespace kerfbench::calibrate {

/// Quantities that may have changed since a head was calibrated.
enum class HeadDrift { kZeroX, kZeroY, kGainX, kGainY, kTurn, kSheetHeight };
inline constexpr std::size_t kHeadDriftCount = 6;
/// "zero of x", "sheet height", …
std::string_view nameOf(HeadDrift drift);
/// " mm", " rad", or empty of a share.
std::string_view unitOf(HeadDrift drift);

struct QuickCheckLimits {
  /// Standard deviations of each before anything is measured; a drift beyond is still found.
  double zero_mm{1.0};
  double gain{2e-3};
  double turn_rad{2e-3};
  double height_mm{2.0};
  double false_alarm{0.01};  ///< Chance that an unchanged head is said to have changed; in (0, 1).
};

struct DriftFinding {
  HeadDrift which{};
  double value{};  ///< Zeros and height in mm on the sheet, gains as a share, turn in rad.
  /// Standard uncertainty, k = 1: of a changed one among the changed ones, else among all six.
  double sigma{};
  bool changed{};  ///< One of the fewest that explain what was measured.
};

struct QuickCheckResult {
  std::array<DriftFinding, kHeadDriftCount> drifts;
  /// The same with the sheet's height taken as unchanged, which then is told as gains: the same quantities
  /// from check to check, whatever changed, and each as well known as the marks allow.
  std::array<DriftFinding, kHeadDriftCount - 1> of_head;
  bool holds{};  ///< Nothing changed beyond what chance explains; one mark at most was rejected.
  /// The changed ones leave more than chance explains: something else is wrong (lens, mirror, sheet).
  bool unexplained{};
  double worst_mm{};       ///< Largest deviation of a mark from where it should be.
  std::size_t rejected{};  ///< Marks that fit to none.
  /// "gain of x changed by +0.00021 ± 0.00006; …", U with k = 2; or "the correction holds".
  std::string words;
};

/// Compares few marks, nine or so, made with the table with where this fit says they must be. The derivatives
/// are the fitted model's: zeros shift the beam, gains scale the mirrors' angles, a turn is that of the whole
/// head, a higher sheet is met earlier. What the fit itself does not know counts as correlated noise. Sheet
/// height and equal gains of both axes are nearly the same thing to a head without a lens: then their sigmas
/// are large, and the smaller set of causes is named.
/// @throws HeadCalibrationError for fewer than five marks, or values that are not finite.
QuickCheckResult quickCheck(const HeadFit& fit, std::span<const HeadObservation> observations,
                            const QuickCheckLimits& limits = {});

}  // namespace kerfbench::calibrate
