// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "twin/cutter/twin.h"

namespace kerfbench::twin {

inline constexpr TickRate kRate{1, 16'000'000};
inline constexpr double kGalvoStepRad = 12.5e-6;
inline constexpr double kTravelStepMm = 0.0125;

constexpr Tick ticks(double time_s) { return kRate.ticksAt(time_s + 1e-9); }

/// Machines of fixtures/machines, shortened: port A carries the axes, C the feed, gate and PWM.
MachineDescription twoMirror();
MachineDescription gantry();
/// A web at 60 mm/s with units of 50 mm; the first eye mark reaches the sensor after 3 mm.
WebDescription lineWeb();
/// A web that feed pulses move.
WebDescription fedWeb();

/// Writes of a controller in any order, delivered as events by tick.
class Pins {
 public:
  explicit Pins(const SignalMap& map) : map_(map) {}
  void set(double time_s, Signal signal, bool level) { writes_.push_back({ticks(time_s), signal, level}); }
  /// Adds `count` pulses, the first at `from_s`, with DIR set 50 us before; the width is 5 us. Returns the
  /// time of the end.
  double steps(Signal pul, double from_s, int count, double period_s, bool forward);
  [[nodiscard]] std::vector<PinEvent> events() const;

 private:
  struct Write {
    Tick tick;
    Signal signal;
    bool level;
  };
  SignalMap map_;
  std::vector<Write> writes_;
};

/// Called after each quantum with the sensor edges that were predicted for it.
using QuantumFn = std::function<void(Tick from, Tick until, const std::vector<SensorEdge>& edges)>;

/// Runs the twin in quanta from tick `from` to `end`. With `each`, sensors are predicted before each quantum.
void run(Twin& twin, const std::vector<PinEvent>& events, Tick from, Tick end, Tick quantum,
         const QuantumFn& each = {});

/// Counts quadrature as any receiver does: A leads B forward, one line at a time.
class QuadratureCounter {
 public:
  void apply(const SensorEdge& edge);
  [[nodiscard]] long long count() const { return count_; }
  [[nodiscard]] int illegal() const { return illegal_; }  ///< Number of edges that changed nothing.

 private:
  bool a_{false}, b_{false};
  long long count_{0};
  int illegal_{0};
};

}  // namespace kerfbench::twin
