// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/run_recorder.h"

#include <stdexcept>

namespace kerfbench::source {

RunRecorder::RunRecorder(const std::vector<Signal>& signals, const SignalMap& map) : signals_(signals) {
  for (const Signal signal : signals) {
    if (!map.pin(signal))
      throw std::invalid_argument("a channel for a signal that the machine does not have");
    pins_.push_back(*map.pin(signal));
  }
}

void RunRecorder::add(const LevelRun& run) {
  if (run.samples == 0) return;
  if (!levels_) {
    first_levels_ = run.levels;
    event(0, run.levels, run.levels);
    start_ = std::move(outputs_);
    outputs_.clear();
  } else if (run.levels != *levels_) {
    if (first_edge_ == 0) first_edge_ = samples_;
    last_edge_ = samples_;
    event(samples_, *levels_ ^ run.levels, run.levels);
  }
  levels_ = run.levels;
  samples_ += run.samples;
}

void RunRecorder::event(std::uint64_t sample, std::uint32_t changed, std::uint32_t levels) {
  std::map<std::uint16_t, std::uint16_t> changed_ports;
  for (std::size_t i = 0; i < pins_.size(); ++i) {
    if ((changed >> i & 1U) == 0) continue;
    if (sample > 0) ++edges_;
    const bool high = (levels >> i & 1U) != 0;
    if (isSensor(signals_[i])) {
      sensors_.push_back({sample, signals_[i], high});
      continue;
    }
    const auto mask = static_cast<std::uint16_t>(1U << pins_[i].bit);
    std::uint16_t& level = port_levels_[pins_[i].port];
    level = static_cast<std::uint16_t>(high ? level | mask : level & ~mask);
    changed_ports[pins_[i].port] |= mask;
  }
  for (const auto& [port, mask] : changed_ports)
    outputs_.push_back({sample, port, mask, port_levels_[port], PinEvent::kNone});
}

PinRecording RunRecorder::recording(std::uint64_t samplerate_hz, const Cut& cut) const {
  PinRecording recording;
  recording.rate = {1, samplerate_hz};
  recording.stamp_err_ticks = 1;
  recording.end = cut.end;
  const auto tickOf = [&](Tick sample) {
    return static_cast<Tick>(static_cast<std::int64_t>(sample) - cut.origin);
  };
  recording.outputs = start_;
  for (PinEvent& event : recording.outputs) event.tick = cut.start;
  recording.outputs.reserve(start_.size() + outputs_.size() + 1);
  for (PinEvent event : outputs_) {
    event.tick = tickOf(event.tick);
    recording.outputs.push_back(event);
  }
  for (SensorEdge edge : sensors_) {
    edge.tick = edge.tick == 0 ? cut.start : tickOf(edge.tick);
    recording.sensors.push_back(edge);
  }
  return recording;
}

}  // namespace kerfbench::source
