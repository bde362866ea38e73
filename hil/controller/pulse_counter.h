// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "hil/controller/uart_listener.h"
#include "hil/inspect/verdict/controller_account.h"
#include "hil/source/encoder_edges.h"
#include "hil/source/vcd.h"

namespace kerfbench::controller {

/// How the controller's UART was heard.
struct UartTiming {
  double baud{};
  double read_delay_s{};  ///< A byte has the time at which it was read: at most so long after it came. >= 0.
};

/// What the pins of a run add up to, from the recording alone: not what the twin made of them.
class PulseCounter {
 public:
  /// The sensors by tick, outputs by tick.
  PulseCounter(const source::PinRecording& recording, const SignalMap& map);

  /// Time of the last rising edge of any PUL; < 0: none.
  [[nodiscard]] double lastPulse_s() const { return last_pulse_s_; }
  /// Time of the rising edge number `count` (from 1) of this PUL; NaN if it never came.
  [[nodiscard]] double pulse_s(Signal pul, long long count) const;
  /// Time of the first rising edge of this PUL that leaves its axis outside of [low, high] steps from where
  /// the recording found it; NaN if none does.
  [[nodiscard]] double leaves_s(Signal pul, long long low, long long high) const;
  /// The first time at which A made the belt look faster than this over `span_s`; NaN if never.
  [[nodiscard]] double beltFaster_s(double counts_per_s, double span_s) const;
  /// Beside what the controller told last; axes that are not wired are left out.
  [[nodiscard]] inspect::ControllerAccount accountBeside(const std::optional<UartListener::Account>& told,
                                                         const UartTiming& uart) const;

 private:
  struct Axis {
    Signal pul{};
    long long net{};
    std::vector<double> pulses_s;
    std::vector<long long> places;  ///< After each of them.
  };
  [[nodiscard]] long long beltCountsAt(double time_s) const;
  /// Least and most counts while the controller can have looked for what it then told.
  [[nodiscard]] std::pair<long long, long long> beltAround(const UartListener::BeltWord& word,
                                                           const UartTiming& uart) const;
  void addOutputs(const source::PinRecording& recording, const SignalMap& map);

  std::vector<Axis> axes_;
  std::vector<source::EncoderEdge> belt_;
  bool belt_wired_{};
  double last_pulse_s_{-1.0};
};

}  // namespace kerfbench::controller
