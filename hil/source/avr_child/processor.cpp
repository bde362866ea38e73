// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/processor.h"

#include <sim_core.h>

#include <algorithm>

namespace kerfbench::avr_child {
namespace {

constexpr std::uint32_t kSpm = 0x95E8, kSpmPostIncrement = 0x95F8;
/// The largest page that SPM erases or writes. simavr erases from Z on, wherever that is in a page.
constexpr std::uint32_t kPageBytes = 256;

}  // namespace

Processor::Processor(avr_t* the_avr)
    : avr(the_avr),
      ram_begin(the_avr->ioend + 1U),
      ram_bytes(the_avr->ramend + 1U - ram_begin),
      flash_bytes(the_avr->flashend + 1U),
      code(flash_bytes / 2 + 3, Operation{&decodeFirst}) {}

std::uint8_t Processor::sreg() const {
  const std::uint32_t c = carries >> 8U & 1U;
  const std::uint32_t h = carries >> 4U & 1U;
  const std::uint32_t n = negative >> 7U & 1U;
  const std::uint32_t v = overflow >> 8U & 1U;
  const std::uint32_t s = n ^ v ^ (overflow >> 16U & 1U);
  const std::uint32_t z = zero == 0 ? 1 : 0;
  const std::uint32_t flags = c << S_C | z << S_Z | n << S_N | v << S_V | s << S_S | h << S_H;
  return static_cast<std::uint8_t>(flags | std::uint32_t{avr->sreg[S_T]} << S_T |
                                   std::uint32_t{avr->sreg[S_I]} << S_I);
}

void Processor::setSreg(std::uint8_t value) {
  const std::uint32_t flags = value;
  carries = (flags >> S_C & 1U) << 8U | (flags >> S_H & 1U) << 4U;
  negative = (flags >> S_N & 1U) << 7U;
  overflow = (flags >> S_V & 1U) << 8U | ((flags >> S_S ^ flags >> S_N ^ flags >> S_V) & 1U) << 16U;
  zero = (flags >> S_Z & 1U) ^ 1U;
  avr->sreg[S_T] = flags >> S_T & 1U;
  const bool enables = (flags >> S_I & 1U) != 0;
  if (enables != (avr->sreg[S_I] != 0)) setInterrupts(enables);
}

void Processor::showFlags() const {
  const std::uint32_t flags = sreg();
  for (unsigned bit = 0; bit < S_T; ++bit) avr->sreg[bit] = flags >> bit & 1U;
}

void Processor::takeFlags() {
  std::uint32_t flags = 0;
  for (unsigned bit = 0; bit < 8; ++bit) flags |= std::uint32_t{avr->sreg[bit]} << bit;
  setSreg(static_cast<std::uint8_t>(flags));
}

void Processor::place(const Operation* at, Cycle now) const {
  avr->pc = pcOf(at);
  avr->cycle = now;
}

void Processor::show(const Operation* at, Cycle now) const {
  place(at, now);
  showFlags();
}

void Processor::setInterrupts(bool enabled) {
  avr_sreg_set(avr, S_I, enabled ? 1 : 0);
  watch();
}

std::uint8_t Processor::readRegister(const Operation* at, Cycle now, std::uint32_t address) {
  std::uint8_t* const data = avr->data;
  if (address == R_SREG) return data[R_SREG] = sreg();
  if (!isReadWatched(address)) return data[address];
  const auto& io = avr->io[AVR_DATA_TO_IO(address)];
  place(at, now);
  if (io.r.c != nullptr) data[address] = io.r.c(avr, static_cast<avr_io_addr_t>(address), io.r.param);
  if (io.irq != nullptr) tellListeners(io.irq, data[address]);
  watch();
  return data[address];
}

void Processor::writeRegister(const Operation* at, Cycle now, std::uint32_t address, std::uint8_t value) {
  std::uint8_t* const data = avr->data;
  if (address == R_SREG) {
    setSreg(value);
    data[R_SREG] = value;
    return;
  }
  if (!isWriteWatched(address)) {
    data[address] = value;
    return;
  }
  const auto& io = avr->io[AVR_DATA_TO_IO(address)];
  place(at, now);
  if (io.w.c != nullptr) {
    io.w.c(avr, static_cast<avr_io_addr_t>(address), value, io.w.param);
  } else {
    data[address] = value;
  }
  if (io.irq != nullptr) tellListeners(io.irq, value);
  watch();
}

void Processor::tellListeners(avr_irq_t* irq, std::uint8_t value) const {
  avr_raise_irq(irq + AVR_IOMEM_IRQ_ALL, value);
  for (unsigned bit = 0; bit < 8; ++bit) avr_raise_irq(irq + bit, value >> bit & 1U);
}

void Processor::watch() {
  const auto* const timer = avr->cycle_timers.timer;
  horizon = timer == nullptr ? limit : std::min<Cycle>(limit, timer->when);
  const bool is_asked = avr->interrupt_state != 0 || avr->run_cycle_count == 0;
  attention = is_asked ? 0 : horizon;
}

void Processor::leaveFlash(std::uint32_t word, Cycle now) const {
  show(code.data(), now);
  avr->pc = 2 * word;
}

void Processor::forgetCode(std::uint32_t pc, std::uint32_t bytes) {
  const std::uint32_t first =
      pc / 2 == 0 ? 0 : pc / 2 - 1;  // The second word of an instruction, or what it skips.
  const std::uint32_t end = std::min(flash_bytes, pc + bytes) / 2;
  for (std::uint32_t word = first; word < end; ++word) code[word].execute = &decodeFirst;
}

void attend(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const auto state = p.avr->interrupt_state;
  if (now >= p.horizon || p.avr->run_cycle_count == 0 || state > 0) return p.show(at, now);
  if (state < 0) avr_service_interrupts(p.avr);  // Counts instructions after SEI, and enters nothing.
  p.watch();
  KERFBENCH_TAIL return at->execute(p, at, now, data);
}

void elsewhere(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  p.show(at, now);
  avr_t* const avr = p.avr;
  avr->run_cycle_count = 1;
  const std::uint32_t z = data[R_ZL] | std::uint32_t{data[R_ZH]} << 8U |
                          (avr->rampz != 0 ? std::uint32_t{data[avr->rampz]} << 16U : 0U);
  const bool is_inside = avr->pc < p.flash_bytes;
  const std::uint32_t code = is_inside ? p.wordAt(avr->pc) : 0;
  avr->pc = avr_run_one(avr);
  p.takeFlags();
  if (code == kSpm || code == kSpmPostIncrement) p.forgetCode(z & ~(kPageBytes - 1), 2 * kPageBytes);
}

}  // namespace kerfbench::avr_child
