// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/run_recorder.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

namespace kerfbench::source {

RunRecorder::RunRecorder(const std::vector<Signal>& signals, const SignalMap& map) {
  for (const Signal signal : signals) {
    if (!map.pin(signal))
      throw std::invalid_argument("a channel for a signal that the machine does not have");
    const std::uint16_t number = map.pin(signal)->port;
    if (!isSensor(signal) && std::ranges::find(ports_, number, &Port::number) == ports_.end())
      ports_.push_back({.number = number});
  }
  std::ranges::sort(ports_, {}, &Port::number);
  for (const Signal signal : signals) {
    const PinId pin = *map.pin(signal);
    const auto port = std::ranges::find(ports_, pin.port, &Port::number) - ports_.begin();
    channels_.push_back({signal, isSensor(signal), static_cast<std::size_t>(port),
                         static_cast<std::uint16_t>(1U << pin.bit)});
  }
}

void RunRecorder::add(const LevelRun& run) {
  if (run.samples == 0) return;
  if (!levels_) {
    first_levels_ = run.levels;
    event(0, run.levels, run.levels);
  } else if (run.levels != *levels_) {
    if (first_edge_ == 0) first_edge_ = samples_;
    last_edge_ = samples_;
    edges_ += static_cast<std::uint64_t>(std::popcount(*levels_ ^ run.levels));
    event(samples_, *levels_ ^ run.levels, run.levels);
  }
  levels_ = run.levels;
  samples_ += run.samples;
}

void RunRecorder::put(Port& port, std::uint64_t sample, std::uint16_t changed) {
  port.level ^= changed;
  outputs_.push_back({sample, port.number, changed, port.level, PinEvent::kNone});
}

void RunRecorder::event(std::uint64_t sample, std::uint32_t changed, std::uint32_t levels) {
  if (std::has_single_bit(changed)) {  // As nearly always.
    const Channel& channel = channels_[static_cast<std::size_t>(std::countr_zero(changed))];
    if (!channel.is_sensor) return put(ports_[channel.port], sample, channel.mask);
  }
  for (std::uint32_t left = changed; left != 0; left &= left - 1) {
    const Channel& channel = channels_[static_cast<std::size_t>(std::countr_zero(left))];
    if (channel.is_sensor) {
      sensors_.push_back({sample, channel.signal, (levels & left & (0U - left)) != 0});
    } else {
      ports_[channel.port].changed |= channel.mask;
    }
  }
  for (Port& port : ports_) {
    if (const auto mask = std::exchange(port.changed, std::uint16_t{0}); mask != 0) put(port, sample, mask);
  }
}

PinRecording RunRecorder::takeRecording(std::uint64_t samplerate_hz, const Cut& cut) {
  PinRecording recording;
  recording.rate = {1, samplerate_hz};
  recording.stamp_err_ticks = 1;
  recording.end = cut.end;
  if (cut.origin == 0 && cut.start == 0) {
    recording.outputs = std::exchange(outputs_, {});
    recording.sensors = std::move(sensors_);
    return recording;
  }
  const auto tickOf = [&](Tick sample) {
    return sample == 0 ? cut.start : static_cast<Tick>(static_cast<std::int64_t>(sample) - cut.origin);
  };
  for (PinEvent event : outputs_) {
    event.tick = tickOf(event.tick);
    recording.outputs.push_back(event);
  }
  for (SensorEdge edge : sensors_.streamed()) {
    edge.tick = tickOf(edge.tick);
    recording.sensors.push_back(edge);
  }
  outputs_.clear();
  sensors_.clear();
  return recording;
}

}  // namespace kerfbench::source
