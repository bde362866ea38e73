// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace kerfbench::diagnose {

/// One opening of the laser's gate in spans of kPowerSpan_s, by the pins alone.
struct PowerRun {
  std::vector<double> light_share;  ///< Share of each span in which the laser shines; 0 … 1.
  std::vector<double> speed_mm_s;   ///< The beam's speed over the sheet, in the same spans.
};
inline constexpr double kPowerSpan_s = 5e-4;

/// A laser whose power goes up and down by itself while the beam keeps its speed.
struct PowerSwing {
  double share{};     ///< Amplitude over the mean: sqrt(2) times the standard deviation.
  double share_U{};   ///< k = 2, from the number of periods that were seen.
  double period_s{};  ///< Known to one span.
};

/// Looks where the beam keeps its speed within 5 % for 20 ms or longer: power over speed, by its mean over
/// such a stretch, and what it has to do with itself some spans later (autocorrelation; Box and Jenkins
/// 1970, 2.1). It swings if it turns into its opposite after half a period and comes back after a whole one.
/// Nullopt if it does not, if the swing is below 5 %, if fewer than ten periods are seen, or if a half is
/// shorter than three spans: that is the PWM itself.
std::optional<PowerSwing> powerSwing(const std::vector<PowerRun>& runs);

}  // namespace kerfbench::diagnose
