// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sim_avr.h>

#include <cstdint>
#include <vector>

#include "hil/source/emulator/tail_call.h"

namespace kerfbench::avr_child {

using Cycle = std::uint64_t;
struct Processor;
struct Operation;

/// Carries out an operation that begins at the cycle `now`, and goes on with those that follow.
using Handler = void (*)(Processor& p, Operation* at, Cycle now, std::uint8_t* data);

/// A decoded instruction. Names of the operands are those of the manual (Atmel 2016).
struct Operation {
  Handler execute{};
  std::int32_t leap{};     ///< Words from here to the target of a branch; words that a skip passes over.
  std::uint16_t number{};  ///< K, k, q, A: constant, address in the data space, displacement.
  std::uint8_t d{};        ///< Rd; a bit's mask where an instruction has one and no Rr.
  std::uint8_t r{};        ///< Rr.
};
static_assert(sizeof(Operation) == 16);

/// What instructions work on: simavr's memories, and the flags of SREG in the form in which they cost least.
///
/// While instructions are carried out, avr_t::pc and avr_t::cycle are those of an earlier instruction, and so
/// are the flags H to C of avr_t::sreg, of which none of simavr's callbacks asks. place() makes the first two
/// true, show() all of them. I and T are always true.
struct Processor {
  explicit Processor(avr_t* the_avr);

  avr_t* avr;
  Cycle attention{};         ///< An instruction that would begin here or later is looked at before.
  Cycle horizon{};           ///< The core stops here.
  Cycle limit{};             ///< The horizon as it was asked for, without simavr's timers.
  std::uint32_t zero{1};     ///< Z is set where this is 0.
  std::uint32_t negative{};  ///< N is its bit 7.
  std::uint32_t overflow{};  ///< V is its bit 8; where its bit 16 is set, S is not N xor V.
  std::uint32_t carries{};   ///< C is its bit 8, H its bit 4.
  std::uint32_t ram_begin;   ///< The first address in the data space behind all registers.
  std::uint32_t ram_bytes;
  std::uint32_t flash_bytes;
  /// For each word of the flash, and as many behind them as an instruction at their end may pass over.
  std::vector<Operation> code;

  [[nodiscard]] std::uint32_t carry() const { return carries >> 8U & 1U; }
  [[nodiscard]] std::uint32_t pcOf(const Operation* at) const {
    return 2 * static_cast<std::uint32_t>(at - code.data());
  }
  [[nodiscard]] bool isRam(std::uint32_t address) const { return address - ram_begin < ram_bytes; }
  [[nodiscard]] bool isRegister(std::uint32_t address) const { return address < ram_begin; }
  [[nodiscard]] bool isCode(std::uint32_t word) const { return word < flash_bytes / 2; }
  [[nodiscard]] std::uint32_t wordAt(std::uint32_t pc) const {
    return avr->flash[pc] | std::uint32_t{avr->flash[pc + 1]} << 8U;
  }

  /// Whether more than the byte has to be read or written: SREG, and registers of which somebody wants to
  /// hear.
  [[nodiscard]] bool isReadWatched(std::uint32_t address) const;
  [[nodiscard]] bool isWriteWatched(std::uint32_t address) const;

  /// The flags of simavr, from ours and back.
  void showFlags() const;
  void takeFlags();
  /// Makes address and cycle of simavr those of the operation; the flags as well.
  void place(const Operation* at, Cycle now) const;
  void show(const Operation* at, Cycle now) const;
  /// SREG as a byte.
  [[nodiscard]] std::uint8_t sreg() const;
  void setSreg(std::uint8_t value);
  void setInterrupts(bool enabled);
  /// An access to a register by its address in the data space, with simavr's callbacks; isRegister() holds.
  std::uint8_t readRegister(const Operation* at, Cycle now, std::uint32_t address);
  void writeRegister(const Operation* at, Cycle now, std::uint32_t address, std::uint8_t value);
  /// Sets `attention` by simavr's timers, and to at once where an interrupt or a callback wants it.
  void watch();
  /// Stops where a jump has led out of the flash.
  void leaveFlash(std::uint32_t word, Cycle now) const;
  void forgetCode(std::uint32_t pc, std::uint32_t bytes);

 private:
  void tellListeners(avr_irq_t* irq, std::uint8_t value) const;
};

inline bool Processor::isReadWatched(std::uint32_t address) const {
  const std::uint32_t index = address - 32;
  if (index >= MAX_IOs) return false;
  return avr->io[index].r.c != nullptr || avr->io[index].irq != nullptr || address == R_SREG;
}

inline bool Processor::isWriteWatched(std::uint32_t address) const {
  const std::uint32_t index = address - 32;
  if (index >= MAX_IOs) return false;
  return avr->io[index].w.c != nullptr || avr->io[index].irq != nullptr || address == R_SREG;
}

/// Decodes an operation and carries it out.
void decodeFirst(Processor& p, Operation* at, Cycle now, std::uint8_t* data);
/// Leaves an operation to simavr, and stops behind it.
void elsewhere(Processor& p, Operation* at, Cycle now, std::uint8_t* data);
/// Stops before an operation, or goes on where that is no place to stop.
void attend(Processor& p, Operation* at, Cycle now, std::uint8_t* data);

/// Begins an operation.
[[gnu::always_inline]] inline void begin(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (now >= p.attention) [[unlikely]]
    KERFBENCH_TAIL return attend(p, at, now, data);
  KERFBENCH_TAIL return at->execute(p, at, now, data);
}

/// Goes on behind an instruction of one word.
[[gnu::always_inline]] inline void next(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  KERFBENCH_TAIL return begin(p, at + 1, now, data);
}

}  // namespace kerfbench::avr_child
