// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "twin/base/pin_event.h"

namespace kerfbench::source {

/// The time scale of a VCD file and how ticks map to its stamps. One unit is 10^-exponent s.
///
/// Where no decimal unit holds a tick exactly (12 MHz: 83.3 ns), stamps are rounded to 1 ps, which still
/// tells ticks apart, so that replay is exact in both cases.
class VcdScale {
 public:
  static constexpr int kFinestExponent = 15;

  VcdScale() = default;
  VcdScale(int exponent, TickRate rate) : exponent_(exponent), rate_(rate) {
    units_per_second_ = 1;
    for (int i = 0; i < exponent; ++i) units_per_second_ *= 10;
    const Wide per_tick = rate.den == 0 || !exact() ? 0 : Wide{rate.num} * units_per_second_ / rate.den;
    if (per_tick >> 64U != 0) return;
    units_per_tick_ = static_cast<std::uint64_t>(per_tick);
    if (units_per_tick_ > 1) ticks_per_unit_ = ~std::uint64_t{0} / units_per_tick_ + 1;
  }

  /// The coarsest scale that is exact, else 1 ps.
  static VcdScale forRate(const TickRate& rate) {
    if (rate.num == 0 || rate.den == 0) throw std::invalid_argument("a tick rate of zero");
    for (int exponent = 0; exponent <= kFinestExponent; ++exponent) {
      VcdScale scale(exponent, rate);
      if (scale.exact()) return scale;
    }
    constexpr int kPicoseconds = 12;
    VcdScale scale(kPicoseconds, rate);
    if (scale.units(1) < 2) throw std::invalid_argument("ticks are too short for a VCD file");
    return scale;
  }

  [[nodiscard]] bool exact() const { return Wide{rate_.num} * units_per_second_ % rate_.den == 0; }

  /// @throws std::invalid_argument beyond the 64 bits of a VCD stamp.
  [[nodiscard]] std::uint64_t stampOf(Tick tick) const {
    const Wide stamp = units(tick);
    if (stamp >> 64U != 0)
      throw std::invalid_argument("tick " + std::to_string(tick) + " is too late for a VCD file");
    return static_cast<std::uint64_t>(stamp);
  }
  /// The tick whose stamp this is; false if there is none.
  [[nodiscard]] bool tickOf(std::uint64_t stamp, Tick& tick) const {
    // Division takes longer than all else that is done with an edge. The inverse is too large by less than
    // units_per_tick_ / 2^64, so that the product with a stamp that is on a tick is too large by less than 1.
    if (units_per_tick_ > 1) {
      tick = static_cast<Tick>(Wide{stamp} * ticks_per_unit_ >> 64U);
      return tick * units_per_tick_ == stamp;
    }
    if (units_per_tick_ == 1) {
      tick = stamp;
      return true;
    }
    const Wide tick_wide = (Wide{stamp} * rate_.den + Wide{rate_.num} * units_per_second_ / 2) /
                           (Wide{rate_.num} * units_per_second_);
    tick = static_cast<Tick>(tick_wide);
    return tick_wide >> 64U == 0 && units(tick) == stamp;
  }
  [[nodiscard]] std::string text() const {
    static constexpr const char* kUnits[] = {"s", "ms", "us", "ns", "ps", "fs"};
    const int unit = (exponent_ + 2) / 3;
    const int zeros = unit * 3 - exponent_;
    return std::string(zeros == 0 ? "1 " : zeros == 1 ? "10 " : "100 ") + kUnits[unit];
  }

 private:
  __extension__ using Wide = unsigned __int128;
  [[nodiscard]] Wide units(Tick tick) const {
    return (Wide{tick} * rate_.num * units_per_second_ + rate_.den / 2) / rate_.den;
  }

  int exponent_{};
  TickRate rate_;
  std::uint64_t units_per_second_{1};
  std::uint64_t units_per_tick_{0};  ///< 0: no whole number, or too large.
  std::uint64_t ticks_per_unit_{0};  ///< Inverse of units_per_tick_, if that is more than 1, times 2^64.
};

}  // namespace kerfbench::source
