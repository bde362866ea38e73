// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>

namespace kerfbench::inspect {

/// Uncertainty of the worst of many readings.
///
/// The largest of N readings is an extreme value: noise alone lifts it, to about 4 sigma for ten thousand
/// places. Let r_i be the readings with standard uncertainties s_i and d_i the true deviations. With 97.7 %
/// confidence
///
///     max |d_i| <= max (|r_i| + 2 s_i)        whatever N is: it holds at the place that is truly the worst;
///     max |d_i| >= max (|r_i| - z_N s_i, 0)   where all N noises stay within z_N s_i with 95.45 %; z_1 = 2.
///
/// value is the middle of the interval and U its half width, so that w = U accepts only if the upper bound is
/// inside the limit and rejects only if the lower bound is outside.
class ExtremeEstimate {
 public:
  explicit ExtremeEstimate(std::size_t readings);

  void add(double reading, double sigma);

  [[nodiscard]] double value() const;                ///< NaN before the first reading.
  [[nodiscard]] double expandedU() const;            ///< NaN before the first reading.
  [[nodiscard]] double raw() const { return raw_; }  ///< Largest |reading| as read.

 private:
  double z_;
  std::size_t count_{};
  double raw_{std::numeric_limits<double>::quiet_NaN()};
  double upper_{std::numeric_limits<double>::quiet_NaN()};
  double lower_{};
};

/// The z within which all of `count` independent standard normal values stay with 95.45 % probability.
double extremeQuantile(std::size_t count);

}  // namespace kerfbench::inspect
