// SPDX-License-Identifier: Apache-2.0
#include "twin/laser/power_noise.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::twin {
namespace {

constexpr double kKnotsPerCorrelation = 8.0;
constexpr std::uint64_t kStream = 0x6c617365;

}  // namespace

PowerNoise::PowerNoise(double deviation, double correlation_s, std::uint64_t seed)
    : random_(seed, kStream), deviation_(deviation), knots_per_s_(kKnotsPerCorrelation / correlation_s) {
  keep_ = std::exp(-1.0 / kKnotsPerCorrelation);
  fresh_ = std::sqrt(1.0 - keep_ * keep_);
}

void PowerNoise::goTo(std::int64_t knot) {
  if (knot < knot_) knot_ = -1;
  if (knot_ < 0) {
    left_ = random_.normal(0);
    right_ = keep_ * left_ + fresh_ * random_.normal(1);
    knot_ = 0;
  }
  for (; knot_ < knot; ++knot_) {
    left_ = right_;
    right_ = keep_ * left_ + fresh_ * random_.normal(static_cast<std::uint64_t>(knot_) + 2);
  }
}

double PowerNoise::at(double place) const {
  return left_ + (right_ - left_) * (place - static_cast<double>(knot_));
}

double PowerNoise::meanOver(double begin_s, double end_s) {
  const double begin = begin_s * knots_per_s_;
  const double end = end_s * knots_per_s_;
  const auto knot = static_cast<std::int64_t>(begin);
  if (knot != knot_) goTo(knot);
  if (end <= static_cast<double>(knot_ + 1)) return deviation_ * at(0.5 * (begin + end));
  double sum = 0.0;
  double from = begin;
  while (end > static_cast<double>(knot_ + 1)) {
    const auto to = static_cast<double>(knot_ + 1);
    sum += (to - from) * at(0.5 * (from + to));
    from = to;
    goTo(knot_ + 1);
  }
  sum += (end - from) * at(0.5 * (from + end));
  return deviation_ * sum / (end - begin);
}

}  // namespace kerfbench::twin
