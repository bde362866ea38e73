// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "hil/evidence/pin_evidence.h"
#include "hil/source/vcd.h"

namespace kerfbench::evidence {

/// Counts the steps of two axes that the pins ask for, one event after the other; as CountedSteps, and
/// without what was before.
class StepCounter {
 public:
  using Steps = std::array<std::int32_t, 2>;
  /// For the first two of the drives. Nullopt if one of their lines is not wired.
  static std::optional<StepCounter> from(const PinWiring& wiring);
  /// The next event by tick.
  void take(const PinEvent& event) {
    for (std::size_t i = 0; i < 2; ++i) now_[i] += axes_[i].stepBy(event);
  }
  [[nodiscard]] const Steps& now() const { return now_; }

 private:
  struct Axis {
    PinId pul, dir;
    std::optional<PinId> enable;
    DriverProfile profile;
    bool pul_high{};
    bool enabled{true};
    std::uint16_t pul_port{}, dir_port{};  ///< Levels of their ports.
    /// The step, if any, that a write brings.
    std::int32_t stepBy(const PinEvent& event);
  };
  std::array<Axis, 2> axes_;
  Steps now_{0, 0};
};

/// The steps of two axes that the pins have asked for, over time, with the sense that their drives give to
/// DIR (DriverProfile::senseOf), without those while a drive was disabled. Nothing else says here whether a
/// drive has followed.
class CountedSteps {
 public:
  using Steps = StepCounter::Steps;

  /// Reads `recording.outputs` for the first two of `drives`. Nullopt if one of their lines is not wired.
  static std::optional<CountedSteps> of(const source::PinRecording& recording, const PinWiring& wiring);
  /// Counts none yet, for a run that still goes on.
  static std::optional<CountedSteps> from(TickRate rate, const PinWiring& wiring);

  /// `events` are those that follow, up to `until`, by tick.
  void add(std::span<const PinEvent> events, Tick until);
  /// No event follows.
  void end() { steps_.push_back(counter_.now()); }

  /// Steps at a time, s from tick 0: as they are at the end of its raster period, after the end as they were
  /// there. Before the end they are known up to kKnownAfter_s before what was added last.
  [[nodiscard]] Steps at(double time_s) const;

  /// What lies before this time may leave the memory: it is read again from a file if it is asked for.
  void passed(double time_s) const;

  /// Each takes 8 bytes of a temporary file, 0.3 GB an hour.
  static constexpr double kRaster_s = 1e-4;
  static constexpr double kKnownAfter_s = 2.0 * kRaster_s;  ///< The period's rest, and one for the rounding.

 private:
  [[nodiscard]] std::size_t indexAt(double time_s) const;
  [[nodiscard]] std::size_t periodOf(Tick tick) const;
  void take(const PinEvent& event);
  void fillBefore(Tick tick);
  void fillUpTo(std::size_t period);

  TickRate rate_;
  StepCounter counter_;
  base::SpilledVector<Steps> steps_;  ///< At the end of each raster period.
  Tick surely_within_{};              ///< Ticks before this one belong to the period that follows steps_.
};

}  // namespace kerfbench::evidence
