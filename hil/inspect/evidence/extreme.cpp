// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/extreme.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::inspect {

double extremeQuantile(std::size_t count) {
  // Two-sided tail of one value so that `count` values stay inside together.
  const double inside = std::erf(2.0 / std::numbers::sqrt2);
  const double tail = -std::expm1(std::log(inside) / static_cast<double>(std::max<std::size_t>(count, 1)));
  double low = 0.0;
  double high = 40.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::numbers::sqrt2) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

ExtremeEstimate::ExtremeEstimate(std::size_t readings) : z_(extremeQuantile(readings)) {}

void ExtremeEstimate::add(double reading, double sigma) {
  const double size = std::abs(reading);
  const double upper = size + 2.0 * sigma;
  if (count_++ == 0) {
    raw_ = size;
    upper_ = upper;
  } else if (std::isnan(upper) || std::isnan(upper_)) {
    upper_ =
        std::numeric_limits<double>::quiet_NaN();  // An unknown uncertainty must not get lost in a maximum.
  } else {
    raw_ = std::max(raw_, size);
    upper_ = std::max(upper_, upper);
  }
  lower_ = std::max(lower_, size - z_ * sigma);
}

double ExtremeEstimate::value() const { return 0.5 * (upper_ + lower_); }
double ExtremeEstimate::expandedU() const { return 0.5 * (upper_ - lower_); }

}  // namespace kerfbench::inspect
