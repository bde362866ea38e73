// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/evidence/active_line.h"
#include "hil/inspect/evidence/pin_evidence.h"
#include "hil/source/vcd.h"
#include "twin/base/pulse_timing.h"
#include "twin/base/signal_map.h"

namespace kerfbench::evidence {

/// The drive of an axis and the lines that it listens to.
struct DriveWiring {
  std::string axis;  ///< As in reports: "galvo_x", …
  Signal pul{}, dir{};
  DriverProfile profile;
};

/// How the machine is wired, as its machine file describes it.
struct PinWiring {
  SignalMap signals;
  bool gate_low{};  ///< The laser may emit while its gate is low, else while it is high.
  bool pwm_low{};   ///< The demand is the share of low, else that of high.
  /// In the order of the report. A drive with a line that `signals` lacks gives no evidence.
  std::vector<DriveWiring> drives;
  double encoder_count_mm{};     ///< Travel of the belt for each quadrature count.
  double power_meter_delay_s{};  ///< From the light to the edge on the meter's pin.
};

/// The laser's gate and PWM; nullopt where they are not wired.
std::optional<ActiveLine> gateLine(const PinWiring& wiring);
std::optional<ActiveLine> pwmLine(const PinWiring& wiring);

/// What the pins say by themselves. Times in s from tick 0 of the recording.
struct PinEvidence {
  std::vector<PulseTiming> pulses;  ///< One for each wired drive.
  /// Sorted by time; a gate that is open at the end closes there. Without a PWM
  /// line the gate may be chopped by its own: pulses no more than 1.1 ms apart are one opening, unless the
  /// guard is open between them.
  std::vector<inspect::GateInterval> gates;
  /// Spans in which the laser emits: gate and PWM are active; the gate alone where no PWM is wired. By time.
  std::vector<inspect::Span> light;
  /// Spans in which the interlock is open, after it was closed for the first time; by time. Absent: the
  /// recording has no edge of it.
  std::optional<std::vector<inspect::Span>> guard_open;
  std::vector<inspect::BeltEdge> belt;  ///< Sorted by time.
  std::vector<double> power_edges_s;    ///< Sorted by time; the meter's delay is taken off.
};

/// Reads a recording and nothing else: no model takes part, so an error in the twin's decoder cannot vouch
/// for itself. `recording.outputs` and `.sensors` by tick.
PinEvidence pinEvidence(const source::PinRecording& recording, const PinWiring& wiring);

}  // namespace kerfbench::evidence
