// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace kerfbench::vision {

/// How light grows with the burn.
struct LightGrowth {
  double law{};    ///< See LightLaw.
  double begin{};  ///< Share of the fluence that cuts through below which nothing is burnt; [0, 0.9].
};

/// Share of the light that comes through board that lets through T when whole and absorbed the share s of the
/// fluence that cuts; by one of a family of laws:
///
///     left = (1 - s) / (1 - begin) within 0 … 1,      L = (1 + left (T^-law - 1))^(-1/law)
///
/// law -1 is in proportion to depth, 0 Beer's law (the limit: T^left), 1 a board that scatters without loss
/// (Kubelka and Munk 1931). 0 < T < 1.
class LightLaw {
 public:
  /// Transmissions out of range count as its ends.
  LightLaw(double transmission, const LightGrowth& growth)
      : law_(growth.law),
        begin_(std::clamp(growth.begin, 0.0, kLatest)),
        log_t_(std::log(std::clamp(transmission, kLeast, kMost))) {
    if (std::abs(law_) > kBeer) grow_ = std::expm1(-law_ * log_t_);
    through_whole_ = lightThrough(1.0);
  }
  [[nodiscard]] double lightAt(double share) const {
    const double left = std::clamp((1.0 - share) / (1.0 - begin_), 0.0, 1.0);
    if (left <= 0.0) return 1.0;
    return left >= 1.0 ? through_whole_ : lightThrough(left);
  }
  /// The share at which so much light comes through, the inverse of lightAt().
  [[nodiscard]] double shareAt(double light) const {
    const double left =
        std::abs(law_) <= kBeer ? std::log(light) / log_t_ : std::expm1(-law_ * std::log(light)) / grow_;
    return 1.0 - (1.0 - begin_) * left;
  }

 private:
  static constexpr double kBeer = 1e-6;
  static constexpr double kLeast = 1e-6;
  static constexpr double kMost = 0.99;
  static constexpr double kLatest = 0.9;
  [[nodiscard]] double lightThrough(double left) const {
    if (std::abs(law_) <= kBeer) return std::exp(log_t_ * left);
    return std::exp(-std::log1p(left * grow_) / law_);
  }

  double law_;
  double begin_;
  double log_t_;
  double grow_{};
  double through_whole_{};
};

/// LightLaw::lightAt() from a table, for pictures of many places.
class FastLaw {
 public:
  FastLaw(double transmission, const LightGrowth& growth) {
    const LightLaw exact(transmission, growth);
    for (std::size_t i = 0; i < table_.size(); ++i)
      table_[i] = static_cast<float>(exact.lightAt(static_cast<double>(i) / kSteps));
    table_.back() = 1.0F;
  }
  [[nodiscard]] float lightAt(float share) const {
    // Whatever a fit tries, not a number included.
    const float place = (share < 1.0F ? std::max(share, 0.0F) : 1.0F) * kSteps;
    const int i = static_cast<int>(place);
    const float t = place - static_cast<float>(i);
    const float* const at = table_.data() + i;
    return at[0] + t * (at[1] - at[0]);
  }

 private:
  static constexpr int kSteps = 256;
  std::array<float, kSteps + 2> table_{};
};

}  // namespace kerfbench::vision
