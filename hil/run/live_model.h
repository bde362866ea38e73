// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "hil/run/lockstep.h"
#include "hil/source/gpio/live_source.h"
#include "twin/description/description.h"

namespace kerfbench::twin {
class Twin;
}

namespace kerfbench::run {

/// The machine of a live run, for its sensors alone: what it cuts is found out afterwards, from the
/// recording.
///
/// Sensors that depend on the clock alone (encoder, print mark, interlock) come from a twin that runs ahead
/// of the clock and is told of no pins. They are as good as in an emulated run, since that twin predicts them
/// by half a millisecond like any other; what mirrors and gantry do to the belt through the frame is left
/// out. Limit switches depend on pins: they come from a second twin, which follows the pins as they are read.
/// GpioLiveSource says what that means in time. Both are fast twins without cameras: about 0.03 s of one core
/// each for a second.
class LiveModel final : public LockstepModel {
 public:
  /// How far ahead of the watermark sensors are predicted: what the watermark is behind the clock, and as
  /// much as this program may be late.
  static constexpr double kAhead_s = 1e-9 * source::GpioLiveSource::kHoldBack_ns + 0.05;

  /// `with_limits`: somebody wants the limit switches of this gantry.
  LiveModel(const twin::MachineDescription& machine, const twin::WebDescription& web, TickRate rate,
            std::uint64_t seed, bool with_limits);
  ~LiveModel() override;

  /// Sensors that are high from before tick 0 on; no edge tells of them.
  [[nodiscard]] const std::vector<Signal>& highAtStart() const { return high_at_start_; }
  /// Not by tick: those of the limit switches come after all others.
  std::vector<SensorEdge> predictSensors(Tick until) override;
  void advance(Tick until, std::span<const PinEvent> events) override;
  [[nodiscard]] double longestQuantum_s() const override { return kStep_s; }

 private:
  static constexpr double kStep_s = 0.5e-3;

  TickRate rate_;
  std::unique_ptr<twin::Twin> ahead_;
  Tick ahead_to_{1};
  std::unique_ptr<twin::Twin> behind_;  ///< May be null.
  std::vector<Signal> high_at_start_;
};

}  // namespace kerfbench::run
