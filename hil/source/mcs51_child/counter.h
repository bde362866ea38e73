// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hil/source/mcs51_child/sfr.h"

namespace kerfbench::mcs51_child {

/// A counter that is only brought up to date when somebody looks at it.
///
/// It counts from `value` to `modulus`, and there starts anew from `reload`. Clocks of the oscillator are
/// divided by `unit` in a divider that runs freely since power came.
class Counter {
 public:
  /// Brings it to `now`, at or after the last call. Returns how often it has overflowed meanwhile.
  std::uint64_t advance(Tick now) {
    if (!runs_) return 0;
    const Tick units = unitsUntil(now);
    if (units <= units_) return 0;
    const std::uint64_t steps = units - units_;
    units_ = units;
    return step(steps);
  }
  /// Counts so many steps, by clocks or by edges of a pin. Returns the overflows.
  std::uint64_t step(std::uint64_t steps) {
    if (steps < modulus_ - value_) {
      value_ += static_cast<std::uint32_t>(steps);
      return 0;
    }
    const std::uint64_t rest = steps - (modulus_ - value_);
    const std::uint64_t period = modulus_ - reload_;
    value_ = static_cast<std::uint32_t>(reload_ + rest % period);
    overflows_ += 1 + rest / period;
    return 1 + rest / period;
  }

  /// @pre It has been advanced to the present.
  void set(std::uint32_t value) { value_ = value < modulus_ ? value : modulus_ - 1; }
  void setReload(std::uint32_t reload) { reload_ = reload; }
  void setRange(std::uint32_t modulus, std::uint32_t reload) {
    modulus_ = modulus;
    reload_ = reload;
    set(value_);
  }
  /// @pre It has been advanced to `now`.
  void setClock(bool runs, std::uint32_t unit, Tick now) {
    runs_ = runs;
    unit_ = unit;
    units_ = unitsUntil(now);
  }

  [[nodiscard]] std::uint32_t value() const { return value_; }
  [[nodiscard]] std::uint32_t reload() const { return reload_; }
  [[nodiscard]] std::uint32_t modulus() const { return modulus_; }
  [[nodiscard]] bool runs() const { return runs_; }
  /// Clocks of the oscillator from an overflow to the next.
  [[nodiscard]] std::uint64_t period() const { return std::uint64_t{modulus_ - reload_} * unit_; }
  /// Overflows since power came.
  [[nodiscard]] std::uint64_t overflows() const { return overflows_; }
  /// The tick at whose end `overflows()` has come to this number; kNever if it does not run.
  [[nodiscard]] Tick tickOfOverflow(std::uint64_t number) const {
    if (!runs_) return kNever;
    if (number <= overflows_) return units_ * unit_;
    const std::uint64_t more = number - overflows_ - 1;
    return (units_ + (modulus_ - value_) + more * (modulus_ - reload_)) * unit_;
  }
  [[nodiscard]] Tick nextOverflow() const { return tickOfOverflow(overflows_ + 1); }

 private:
  /// A division by a constant takes a tenth of the time of one by a variable.
  [[nodiscard]] Tick unitsUntil(Tick tick) const {
    switch (unit_) {
      case 1:
        return tick;
      case 2:
        return tick / 2;
      case 12:
        return tick / 12;
      default:
        return tick / unit_;
    }
  }

  std::uint32_t value_{};
  std::uint32_t modulus_{8192};
  std::uint32_t reload_{};
  std::uint32_t unit_{12};
  bool runs_{};
  Tick units_{};  // Counted until here, in units; only while it runs.
  std::uint64_t overflows_{};
};

}  // namespace kerfbench::mcs51_child
