// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hil/controller/uart_listener.h"
#include "hil/inspect/verdict/controller_account.h"
#include "hil/source/encoder_edges.h"
#include "hil/source/vcd.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::controller {

/// Timing of the bytes received on the controller's UART.
struct UartTiming {
  double baud{};
  double read_delay_s{};  ///< Longest time from a byte's arrival to its stamp, the time of reading; >= 0.
};

/// What the drive behind a PUL makes of its lines; those of which nothing is said step on the rising edge,
/// and forwards while DIR is high.
using DriveOfPul = std::pair<Signal, DriverProfile>;

/// Name of the axis of a PUL, "gantry_x".
std::string axisNameOf(Signal pul);

/// Sums over the pins of a run, from the recording alone, without the twin.
class PulseCounter {
 public:
  /// Counts a recording whose sensors and outputs are sorted by tick.
  PulseCounter(const source::PinRecording& recording, const SignalMap& map,
               std::span<const DriveOfPul> drives = {});

  /// Time of the last active edge of any PUL; < 0: none.
  [[nodiscard]] double lastPulse_s() const { return last_pulse_s_; }
  /// Steps of this PUL's axis from where the recording found it; nullopt if it is not wired.
  [[nodiscard]] std::optional<long long> net(Signal pul) const;
  /// Time of the active edge number `count` (from 1) of this PUL; NaN if it never came.
  [[nodiscard]] double pulse_s(Signal pul, long long count) const;
  /// Time of the first active edge of this PUL that leaves its axis outside of [low, high] steps from where
  /// the recording found it; NaN if none does.
  [[nodiscard]] double leaves_s(Signal pul, long long low, long long high) const;
  /// The first time at which A made the belt look faster than this over `span_s`; NaN if never.
  [[nodiscard]] double beltFaster_s(double counts_per_s, double span_s) const;
  /// Comparison of the pins with the controller's last report, without axes that are not wired.
  [[nodiscard]] inspect::ControllerAccount compareWithReport(
      const std::optional<UartListener::Account>& report, const UartTiming& uart) const;

 private:
  struct Axis {
    Signal pul{};
    PinId pul_pin, dir_pin;
    std::optional<PinId> enable_pin;
    DriverProfile drive;
    bool dir{};
    bool enabled{};
    long long net{};  ///< Steps from the start.
    /// Events by tick; true: this one brings an active edge of PUL, after which the axis is at `net`.
    bool take(const PinEvent& event);
    void restart();
  };
  /// Calls `take` with tick and place of the pulses of an axis, in order, until it says false.
  template <class Take>
  void forEachPulse(Axis axis, Take take) const;
  [[nodiscard]] long long beltCountsAt(double time_s) const;
  /// Least and most counts of the belt while the controller can have sampled what it then reported.
  [[nodiscard]] std::pair<long long, long long> beltAround(const UartListener::BeltWord& word,
                                                           const UartTiming& uart) const;

  TickRate rate_;
  source::PinEvents outputs_;  ///< A copy of the recording's, which shares its file.
  std::vector<Axis> axes_;
  base::SpilledVector<source::EncoderEdge> belt_;
  bool belt_wired_{};
  double last_pulse_s_{-1.0};
};

}  // namespace kerfbench::controller
