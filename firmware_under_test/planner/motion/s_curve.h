// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kerfbench::planner {

/// Motion along a path under constant jerk, from s_mm on.
struct Phase {
  double s_mm{}, v_mm_s{}, a_mm_s2{}, j_mm_s3{}, duration_s{};

  [[nodiscard]] double travelMm(double t_s) const {
    return t_s * (v_mm_s + t_s * (0.5 * a_mm_s2 + t_s * j_mm_s3 / 6.0));
  }
};

/// Limits for changes of the speed along a path. With a jerk a change of speed is an S-curve that begins and
/// ends without acceleration.
struct Ramp {
  double acceleration_mm_s2{};  ///< Acceleration; > 0.
  double jerk_mm_s3{};          ///< Jerk; 0: no limit.

  /// Duration and length of a change of speed; both kinds of ramp are symmetrical in time.
  [[nodiscard]] double durationS(double v0_mm_s, double v1_mm_s) const;
  [[nodiscard]] double travelMm(double v0_mm_s, double v1_mm_s) const;
  /// Longest travel of all changes from the faster of these speeds to one that is not below the slower: never
  /// less than travelMm(), and not growing with the slower speed. An S-curve between w and rest is up to 9 %
  /// shorter than one between w and w/3.
  [[nodiscard]] double mostTravelMm(double v0_mm_s, double v1_mm_s) const;
  /// Highest speed between two ends that leaves room for both ramps, at most `limit`; never below the ends.
  [[nodiscard]] double peakMmS(double length_mm, double v0_mm_s, double v1_mm_s, double limit_mm_s) const;
  /// Appends the phases of a change that begins at s0_mm.
  void addPhases(double v0_mm_s, double v1_mm_s, double s0_mm, std::vector<Phase>& phases) const;
};

/// Arc lengths at the end of each of `periods` equal times, the first 0 and the last total_mm.
std::vector<double> stationsOf(const std::vector<Phase>& phases, int periods, double total_mm);

double durationOf(const std::vector<Phase>& phases);

/// Highest x of low … high with excess(x) <= 0, which grows with x; `low` if there is none. Method: false
/// position (Illinois), to twelve digits.
template <typename Excess>
double highest(double low, double high, const Excess& excess) {
  double at_high = excess(high);
  if (at_high <= 0.0) return high;
  double at_low = excess(low);
  if (at_low >= 0.0) return low;
  int side = 0;  // Side that moved last.
  for (int i = 0; i < 100 && high - low > 1e-12 * high; ++i) {
    const double x = (low * at_high - high * at_low) / (at_high - at_low);
    if (!(x > low && x < high)) break;
    const double at = excess(x);
    if (at <= 0.0) {
      low = x;
      at_low = at;
      if (side < 0) at_high *= 0.5;
      side = -1;
    } else {
      high = x;
      at_high = at;
      if (side > 0) at_low *= 0.5;
      side = 1;
    }
  }
  return low;
}

}  // namespace kerfbench::planner
