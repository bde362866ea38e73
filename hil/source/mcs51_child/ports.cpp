// SPDX-License-Identifier: Apache-2.0
#include "hil/source/mcs51_child/ports.h"

#include <algorithm>

namespace kerfbench::mcs51_child {

std::uint8_t Ports::driven(const Port& port) {
  const unsigned listens = port.m1 & ~unsigned{port.m0};
  return static_cast<std::uint8_t>(port.latch & ~port.pulled & ~listens);
}

std::uint8_t Ports::pins(unsigned index) const {
  const Port& port = ports_[index];
  const unsigned listens = port.m1 & ~unsigned{port.m0};
  const unsigned pushes = port.m0 & ~unsigned{port.m1};
  const unsigned low = ~unsigned{port.latch} | port.pulled;
  return static_cast<std::uint8_t>((pushes & ~low) | (~pushes & ~listens & port.outside & ~low) |
                                   (listens & port.outside & port.is_driven));
}

void Ports::reset(Tick tick) {
  for (unsigned i = 0; i < kPorts; ++i) {
    auto& port = ports_[i];
    port.latch = 0xFF;
    port.pulled = port.m0 = 0;
    port.m1 = part_.listens_after_reset[i];
    update(i, tick);
  }
}

void Ports::drive(unsigned index, unsigned bit, bool level) {
  auto& port = ports_[index];
  const unsigned mask = 1U << bit;
  port.outside = static_cast<std::uint8_t>(level ? port.outside | mask : port.outside & ~mask);
  port.is_driven = static_cast<std::uint8_t>(port.is_driven | mask);
}

void Ports::setLatch(unsigned index, std::uint8_t value, Tick tick) {
  ports_[index].latch = value;
  update(index, tick);
}

void Ports::setMode(unsigned index, bool is_m1, std::uint8_t value, Tick tick) {
  auto& port = ports_[index];
  (is_m1 ? port.m1 : port.m0) = value;
  update(index, tick);
}

void Ports::setPulledByPeripheral(unsigned index, std::uint8_t mask, bool is_low, Tick tick) {
  auto& port = ports_[index];
  port.pulled = static_cast<std::uint8_t>(is_low ? port.pulled | mask : port.pulled & ~mask);
  update(index, tick);
}

void Ports::update(unsigned index, Tick tick) {
  auto& port = ports_[index];
  const auto level = static_cast<std::uint8_t>(driven(port) & bitsOf(index));
  const auto changed = static_cast<std::uint16_t>(level ^ port.told);
  if (changed == 0) return;
  port.told = level;
  // What happens to a port in one tick is one event.
  for (auto event = events_.rbegin(); event != events_.rend() && event->tick == tick; ++event) {
    if (event->port != index) continue;
    event->changed = static_cast<std::uint16_t>(event->changed ^ changed);
    event->level = level;
    if (event->changed == 0) events_.erase(std::next(event).base());
    return;
  }
  if (events_.size() >= max_events_) {
    is_flooded_ = true;
    return;
  }
  events_.push_back({tick, static_cast<std::uint16_t>(index), changed, level});
}

std::vector<emulator::PinEvent> Ports::take(Tick until) {
  std::vector<emulator::PinEvent> taken;
  if (events_.empty() || events_.back().tick <= until) {
    taken.swap(events_);
    return taken;
  }
  const auto end = std::ranges::upper_bound(events_, until, {}, &emulator::PinEvent::tick);
  taken.assign(events_.begin(), end);
  events_.erase(events_.begin(), end);
  return taken;
}

}  // namespace kerfbench::mcs51_child
