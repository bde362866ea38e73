// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "hil/evidence/active_line.h"
#include "hil/inspect/evidence/evidence.h"
#include "twin/base/pin_event.h"

namespace kerfbench::judge {

/// When frames of the spot camera are wanted, as far as a run has got: from a margin before the laser's gate
/// was opened for the first time to a margin after it was closed for the last. Times are those of the pins,
/// s.
class WantedSpan {
 public:
  /// `lag_s`: what is known of the run ends so long before now, >= 0.
  WantedSpan(evidence::ActiveLine gate, TickRate rate, double margin_s, double lag_s)
      : gate_(gate), rate_(rate), margin_s_(margin_s), lag_s_(lag_s) {}

  /// The controller's events up to `until`, by tick.
  void add(std::span<const PinEvent> events, Tick until);
  /// Frames that begin in there are wanted, whatever follows; those before never are. None so far: it ends
  /// before it begins.
  [[nodiscard]] inspect::Span soFar() const;
  /// After the end of the run. Nullopt: the gate was never opened.
  [[nodiscard]] std::optional<inspect::Span> inAll() const;

 private:
  evidence::ActiveLine gate_;
  TickRate rate_;
  double margin_s_;
  double lag_s_;
  double now_s_{0.0};
  std::optional<double> first_on_s_;
  double last_off_s_{0.0};
};

}  // namespace kerfbench::judge
