// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/pins.h"

#include <algorithm>
#include <iterator>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kModesLow = 0x00, kModesHigh = 0x04, kInput = 0x08, kOutput = 0x0C, kSetReset = 0x10,
                        kReset = 0x14, kLock = 0x18;

}  // namespace

Pins::Pins(Present& present, const CoreTime& time, std::size_t max_events)
    : present_(present), time_(time), max_events_(max_events) {
  for (unsigned i = 0; i < kPorts; ++i) {
    ports_[i].owner = this;
    ports_[i].index = static_cast<std::uint16_t>(i);
    ports_[i].modes = kFloatingInputs;
  }
}

void Pins::reset() {
  for (Port& port : ports_) port.reset();
}

void Pins::Port::reset() {
  modes = kFloatingInputs;
  latch = lock = taken = timer_level = 0;
  owner->decode(*this);
}

std::uint32_t Pins::Port::read(std::uint32_t offset) {
  switch (offset) {
    case kModesLow:
      return static_cast<std::uint32_t>(modes);
    case kModesHigh:
      return static_cast<std::uint32_t>(modes >> 32);
    case kInput:
      return seen;
    case kOutput:
      return latch;
    case kLock:
      return lock;
    default:
      return 0;
  }
}

void Pins::Port::write(std::uint32_t offset, std::uint32_t value) {
  constexpr std::uint64_t kLowHalf = 0xFFFFFFFF;
  switch (offset) {
    case kModesLow:
      modes = (modes & ~kLowHalf) | value;
      return owner->decode(*this);
    case kModesHigh:
      modes = (modes & kLowHalf) | std::uint64_t{value} << 32;
      return owner->decode(*this);
    case kOutput:
      latch = value & 0xFFFFU;
      return owner->update(*this);
    case kSetReset:
      latch = (latch & ~(value >> 16)) | (value & 0xFFFFU);
      return owner->update(*this);
    case kReset:
      latch &= ~(value & 0xFFFFU);
      return owner->update(*this);
    case kLock:
      lock = value & 0x1FFFFU;
      return;
    default:
      return;
  }
}

void Pins::decode(Port& port) {
  port.outputs = port.open_drain = port.alternate = port.pulled = port.analog = 0;
  for (unsigned bit = 0; bit < 16; ++bit) {
    const std::uint32_t mode = port.mode(bit);
    const std::uint32_t mask = 1U << bit;
    if ((port.foreign & mask) != 0) continue;
    if ((mode & 3U) != 0) {
      port.outputs |= mask;
      if ((mode & 4U) != 0) port.open_drain |= mask;
      if ((mode & 8U) != 0) port.alternate |= mask;
    } else if (mode == 8) {
      port.pulled |= mask;
    } else if (mode == 0) {
      port.analog |= mask;
    }
  }
  update(port);
}

void Pins::update(Port& port) {
  const std::uint32_t wanted =
      (port.latch & ~port.alternate) | (port.timer_level & port.taken & port.alternate);
  const std::uint32_t level = wanted & port.outputs;
  const std::uint32_t pulls_low = port.outputs & port.open_drain & ~wanted;
  const std::uint32_t strong = (port.outputs & ~port.open_drain) | pulls_low;
  const std::uint32_t outside =
      (port.driven & port.driven_level) |
      (~port.driven & ((port.pulled & port.latch) | (port.open_drain & port.outputs & wanted)));
  const std::uint32_t seen = ((level & strong) | (outside & ~strong)) & ~port.analog & 0xFFFFU;
  if (const std::uint32_t changed = level ^ port.level; changed != 0) {
    port.level = level;
    note(port, static_cast<std::uint16_t>(changed));
  }
  if (const std::uint32_t changed = seen ^ port.seen; changed != 0) {
    port.seen = seen;
    if (on_change) on_change(port.index, changed);
  }
}

/// A core that is faster than the ticks has several cycles in one, in which a pin changes once or not at all.
void Pins::note(const Port& port, std::uint16_t changed) {
  const std::uint64_t tick = std::max(time_.tickOf(present_.cycle), taken_to_ + 1);
  const auto level = static_cast<std::uint16_t>(port.level);
  for (auto event = events_.rbegin(); event != events_.rend() && event->tick == tick; ++event) {
    if (event->port != port.index) continue;
    event->changed ^= changed;
    event->level = level;
    if (event->changed == 0) events_.erase(std::next(event).base());
    return;
  }
  if (events_.size() < max_events_) {
    events_.push_back({tick, port.index, changed, level});
  } else {
    flooded_ = true;
  }
}

void Pins::drive(Pin pin, bool level) {
  Port& port = ports_[pin.port];
  const std::uint32_t mask = 1U << pin.bit;
  port.driven |= mask;
  port.driven_level = level ? port.driven_level | mask : port.driven_level & ~mask;
  update(port);
}

void Pins::setTaken(Pin pin, bool is_taken) {
  Port& port = ports_[pin.port];
  const std::uint32_t mask = 1U << pin.bit;
  port.foreign = is_taken ? port.foreign | mask : port.foreign & ~mask;
  decode(port);
}

void Pins::setAlternate(Pin pin, bool is_taken, bool level) {
  Port& port = ports_[pin.port];
  const std::uint32_t mask = 1U << pin.bit;
  port.taken = is_taken ? port.taken | mask : port.taken & ~mask;
  port.timer_level = level ? port.timer_level | mask : port.timer_level & ~mask;
  update(port);
}

std::vector<emulator::PinEvent> Pins::take(std::uint64_t until_tick) {
  const auto later =
      std::ranges::find_if(events_, [&](const emulator::PinEvent& event) { return event.tick > until_tick; });
  std::vector<emulator::PinEvent> taken(events_.begin(), later);
  events_.erase(events_.begin(), later);
  taken_to_ = until_tick;
  return taken;
}

}  // namespace kerfbench::cortex_m_child
