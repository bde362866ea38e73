// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/pins.h"

#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace kerfbench::avr_child {

Pins::Pins(avr_t* avr, std::size_t max_events) : avr_(avr), max_events_(max_events) {
  for (avr_io_t* io = avr->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "port") != 0) continue;
    auto* ioport = reinterpret_cast<avr_ioport_t*>(io);
    const int index = ioport->name - 'A';
    if (index < 0 || index >= static_cast<int>(kPorts)) continue;
    auto port = std::make_unique<Port>();
    port->owner = this;
    port->io = ioport;
    port->index = static_cast<std::uint16_t>(index);
    avr_irq_register_notify(io->irq + IOPORT_IRQ_REG_PORT, onPort, port.get());
    avr_irq_register_notify(io->irq + IOPORT_IRQ_DIRECTION_ALL, onDirection, port.get());
    port->write_pin = takeOver(ioport->r_pin, onPinWrite, *port);
    port->write_port = takeOver(ioport->r_port, onPortWrite, *port);
    ports_[static_cast<std::size_t>(index)] = std::move(port);
  }
}

Pins::Writer Pins::takeOver(avr_io_addr_t addr, avr_io_write_t handler, Port& port) {
  auto& writer = avr_->io[AVR_DATA_TO_IO(addr)].w;
  return {std::exchange(writer.c, handler), std::exchange(writer.param, static_cast<void*>(&port))};
}

void Pins::onPort(avr_irq_t* /*irq*/, std::uint32_t value, void* param) {
  auto& port = *static_cast<Port*>(param);
  port.latch = static_cast<std::uint8_t>(value);
  port.owner->update(port);
}

void Pins::onDirection(avr_irq_t* /*irq*/, std::uint32_t value, void* param) {
  auto& port = *static_cast<Port*>(param);
  port.direction = static_cast<std::uint8_t>(value);
  port.owner->update(port);
}

// Writing ones to PIN toggles PORT. simavr carries out `sbi PINx, n` as read, or, write, and so toggles every
// pin that happens to be high; on silicon SBI touches one bit.
void Pins::onPinWrite(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param) {
  const auto& port = *static_cast<const Port*>(param);
  const unsigned opcode = avr->flash[avr->pc] | static_cast<unsigned>(avr->flash[avr->pc + 1] << 8);
  if ((opcode & 0xFF00U) == 0x9A00U) value = static_cast<std::uint8_t>(1U << (opcode & 7U));
  port.write_pin.call(avr, addr, value, port.write_pin.param);
}

// simavr tells all of a port's pins to their listeners. Here only those that change are told, which is the
// same as long as no input's pull-up is switched.
void Pins::onPortWrite(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param) {
  const auto& port = *static_cast<const Port*>(param);
  const unsigned changed = avr->data[addr] ^ unsigned { value };
  if ((changed & ~unsigned{avr->data[port.io->r_ddr]}) != 0)
    return port.write_port.call(avr, addr, value, port.write_port.param);
  avr->data[addr] = value;
  if (changed == 0) return;
  avr_irq_t* const irq = port.io->io.irq;
  avr_raise_irq(irq + IOPORT_IRQ_REG_PORT, value);
  for (unsigned bit = 0; bit < 8; ++bit) {
    if ((changed >> bit & 1U) != 0) avr_raise_irq(irq + bit, unsigned{value} >> bit & 1U);
  }
}

int Pins::portOf(avr_io_addr_t port_register) const {
  for (const auto& port : ports_) {
    if (port && port->io->r_port == port_register) return port->index;
  }
  return -1;
}

void Pins::setCompareOutput(int port_index, unsigned bit, bool connected, bool level) {
  auto& port = *ports_.at(static_cast<std::size_t>(port_index));
  const auto mask = static_cast<std::uint8_t>(1U << bit);
  const auto put = [mask](std::uint8_t& byte, bool on) {
    byte = static_cast<std::uint8_t>(on ? byte | mask : byte & ~mask);
  };
  put(port.connected, connected);
  put(port.compare, level);
  update(port);
}

void Pins::refresh() {
  for (const auto& port : ports_) {
    if (!port) continue;
    port->latch = avr_->data[port->io->r_port];
    port->direction = avr_->data[port->io->r_ddr];
    // The IRQs are filtered: without this the first write after a reset would look like no change.
    port->io->io.irq[IOPORT_IRQ_REG_PORT].value = port->latch;
    port->io->io.irq[IOPORT_IRQ_DIRECTION_ALL].value = port->direction;
    update(*port);
  }
}

void Pins::update(Port& port) {
  const unsigned output = (port.latch & ~port.connected) | (port.compare & port.connected);
  const auto level = static_cast<std::uint8_t>(output & port.direction);
  const auto changed = static_cast<std::uint8_t>(level ^ port.level);
  if (changed == 0) return;
  port.level = level;
  const std::uint64_t tick = avr_->cycle + (in_timer_ ? 0U : 1U);
  // What happens to a port in one tick is one event.
  for (auto event = events_.rbegin(); event != events_.rend() && event->tick == tick; ++event) {
    if (event->port != port.index) continue;
    event->changed = static_cast<std::uint16_t>(event->changed ^ changed);
    event->level = level;
    if (event->changed == 0) events_.erase(std::next(event).base());
    return;
  }
  if (events_.size() >= max_events_) {
    flooded_ = true;
    avr_->run_cycle_count = 0;  // Leave the core's loop after this instruction.
    return;
  }
  events_.push_back({tick, port.index, changed, level});
}

std::vector<PinEvent> Pins::take() {
  std::vector<PinEvent> taken;
  taken.swap(events_);
  return taken;
}

void Pins::drive(std::uint16_t port_index, std::uint16_t bit, bool level) {
  if (port_index >= kPorts || !ports_[port_index] || bit > 7) {
    throw std::runtime_error("the controller has no pin " +
                             std::string(1, static_cast<char>('A' + port_index % 26)) + std::to_string(bit));
  }
  auto& port = *ports_[port_index];
  const auto mask = static_cast<std::uint8_t>(1U << bit);
  port.driven_mask = static_cast<std::uint8_t>(port.driven_mask | mask);
  port.driven_level = static_cast<std::uint8_t>(level ? port.driven_level | mask : port.driven_level & ~mask);
  applyExternal(port);
  avr_raise_irq(port.io->io.irq + bit, level ? 1 : 0);
}

// Without the external levels, the next write to the port would pull the input up again.
void Pins::applyExternal(const Port& port) { port.io->external = {port.driven_mask, port.driven_level}; }

void Pins::redrive() {
  for (const auto& port : ports_) {
    if (!port || port->driven_mask == 0) continue;
    applyExternal(*port);
    for (unsigned bit = 0; bit < 8; ++bit) {
      if ((port->driven_mask >> bit & 1U) == 0) continue;
      auto* irq = port->io->io.irq + bit;
      const std::uint32_t level = port->driven_level >> bit & 1U;
      irq->value = level ^ 1U;
      avr_raise_irq(irq, level);
    }
  }
}

}  // namespace kerfbench::avr_child
