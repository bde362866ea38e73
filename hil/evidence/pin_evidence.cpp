// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/pin_evidence.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "hil/evidence/port_levels.h"
#include "hil/evidence/pulse_timer.h"
#include "hil/source/encoder_edges.h"

namespace kerfbench::evidence {
namespace {

/// A drive whose lines are both wired.
struct WatchedDrive {
  PinId pul, dir;
  std::optional<PinId> enable;
  PulseTimer timer;

  void take(const PinEvent& event, double time_s, const PortLevels& ports) {
    if (enable && enable->port == event.port) timer.enableLevel(time_s, ports.high(*enable));
    if (pul.port == event.port || dir.port == event.port)
      timer.levels(time_s, ports.high(pul), ports.high(dir));
  }
};

std::vector<WatchedDrive> watchedDrives(const PinWiring& wiring) {
  std::vector<WatchedDrive> drives;
  for (const DriveWiring& drive : wiring.drives) {
    const std::optional<PinId> pul = wiring.signals.pin(drive.pul);
    const std::optional<PinId> dir = wiring.signals.pin(drive.dir);
    const std::optional<PinId> enable = wiring.signals.pin(enableOf(drive.pul));
    if (pul && dir)
      drives.push_back({*pul, *dir, enable, PulseTimer(drive.axis, drive.profile, enable.has_value())});
  }
  return drives;
}

/// Spans in which something was so.
class SpanWatch {
 public:
  void level(double time_s, bool high) {
    if (high == open_) return;
    open_ = high;
    if (high) {
      spans_.push_back({time_s, time_s});
    } else {
      spans_.back().to_s = time_s;
    }
  }
  std::vector<inspect::Span> until(double end_s) {
    if (open_) spans_.back().to_s = end_s;
    return std::move(spans_);
  }

 private:
  std::vector<inspect::Span> spans_;
  bool open_{false};
};

/// Dark for no longer than this, a gate without a PWM line is chopped, and open all the while: Grbl's spindle
/// PWM, on which the laser hangs, has 976 Hz by default, and lasers take no slower one. Where the guard is
/// open meanwhile it was shut.
constexpr double kChopped_s = 1.1e-3;

std::vector<inspect::GateInterval> choppedGates(const std::vector<inspect::Span>& spans,
                                                const std::vector<inspect::Span>& guard_open) {
  std::vector<inspect::GateInterval> gates;
  const auto isGuarded = [&](double from_s, double to_s) {
    return std::ranges::none_of(
        guard_open, [&](const inspect::Span& open) { return open.from_s <= to_s && open.to_s >= from_s; });
  };
  for (const inspect::Span& span : spans) {
    if (!gates.empty() && span.from_s - gates.back().off_s <= kChopped_s &&
        isGuarded(gates.back().off_s, span.from_s)) {
      gates.back().off_s = span.to_s;
    } else {
      gates.push_back({span.from_s, span.to_s});
    }
  }
  return gates;
}

std::optional<std::vector<inspect::Span>> guardOpen(const source::PinRecording& recording) {
  SpanWatch open;
  bool was_closed = false;
  for (const SensorEdge& edge : recording.sensors.streamed()) {
    if (edge.signal != Signal::kInterlock) continue;
    was_closed = was_closed || edge.level;
    if (was_closed) open.level(recording.rate.seconds(edge.tick), !edge.level);
  }
  if (!was_closed) return std::nullopt;
  return open.until(recording.rate.seconds(recording.end));
}

std::vector<inspect::BeltEdge> beltEdges(const source::PinRecording& recording, double count_mm) {
  std::vector<inspect::BeltEdge> belt;
  belt.reserve(
      recording.sensors.size());  // Nearly all are the encoder's, and a vector that grows is there twice.
  source::EncoderCounter encoder(recording.rate);
  for (const SensorEdge& sensor : recording.sensors.streamed()) {
    if (const auto edge = encoder.take(sensor))
      belt.push_back({edge->time_s, static_cast<double>(edge->counts) * count_mm});
  }
  return belt;
}

std::vector<double> powerEdges(const source::PinRecording& recording, double delay_s) {
  std::vector<double> edges_s;
  bool high = false;
  for (const SensorEdge& edge : recording.sensors.streamed()) {
    if (edge.signal != Signal::kPowerMonitor || edge.level == high) continue;
    high = edge.level;
    edges_s.push_back(recording.rate.seconds(edge.tick) - delay_s);
  }
  return edges_s;
}

}  // namespace

std::optional<ActiveLine> gateLine(const PinWiring& wiring) {
  const std::optional<PinId> pin = wiring.signals.pin(Signal::kLaserGate);
  return pin ? std::optional(ActiveLine(*pin, wiring.gate_low)) : std::nullopt;
}

std::optional<ActiveLine> pwmLine(const PinWiring& wiring) {
  const std::optional<PinId> pin = wiring.signals.pin(Signal::kLaserPwm);
  return pin ? std::optional(ActiveLine(*pin, wiring.pwm_low)) : std::nullopt;
}

PinEvidence pinEvidence(const source::PinRecording& recording, const PinWiring& wiring) {
  std::vector<WatchedDrive> drives = watchedDrives(wiring);
  std::optional<ActiveLine> gate = gateLine(wiring);
  std::optional<ActiveLine> pwm = pwmLine(wiring);
  SpanWatch gates;
  SpanWatch light;
  PortLevels ports;
  for (const PinEvent& event : recording.outputs) {
    ports.apply(event);
    const double time_s = recording.rate.seconds(event.tick);
    for (WatchedDrive& drive : drives) drive.take(event, time_s, ports);
    if (!gate) continue;
    gate->take(event);
    if (pwm) pwm->take(event);
    gates.level(time_s, gate->isActive());
    light.level(time_s, gate->isActive() && (!pwm || pwm->isActive()));
  }
  PinEvidence result;
  for (const WatchedDrive& drive : drives) result.pulses.push_back(drive.timer.timing());
  const double end_s = recording.rate.seconds(recording.end);
  result.light = light.until(end_s);
  result.guard_open = guardOpen(recording);
  if (pwm) {
    for (const inspect::Span& span : gates.until(end_s)) result.gates.push_back({span.from_s, span.to_s});
  } else {
    result.gates = choppedGates(gates.until(end_s), result.guard_open.value_or(std::vector<inspect::Span>{}));
  }
  result.belt = beltEdges(recording, wiring.encoder_count_mm);
  result.power_edges_s = powerEdges(recording, wiring.power_meter_delay_s);
  return result;
}

}  // namespace kerfbench::evidence
