// SPDX-License-Identifier: Apache-2.0
#pragma once

// Jumps, calls, and what columns 0 to 3 have besides; run.cpp alone includes this.
#include <algorithm>

#include "hil/source/mcs51_child/cpu.h"
#include "hil/source/mcs51_child/instructions.h"

namespace kerfbench::mcs51_child {

/// How often the instruction under way could be carried out again with its end not behind the horizon, before
/// which nothing else happens.
[[gnu::always_inline]] inline std::uint64_t Cpu::wholeTurns() const {
  return horizon_ > ends_ ? (horizon_ - ends_) / clocks_[code_[began_at_]] : 0;
}

/// Turns that are as the one under way: their time passes, and nothing is done.
[[gnu::always_inline]] inline void Cpu::passOver(std::uint64_t turns) {
  if (turns == 0) return;
  passed_ = turns * clocks_[code_[began_at_]];
  attend(0);
}

/// A relative jump, from the address behind its operand.
[[gnu::always_inline]] inline void Cpu::jumpIf(Pc& pc, bool is_taken) {
  const auto distance = static_cast<std::int8_t>(operand(pc));
  if (is_taken) pc = static_cast<std::uint16_t>(static_cast<int>(pc) + distance);
}

/// A jump that depends on nothing, or on a bit that only something from outside can change meanwhile. Where
/// it leads to itself, each turn is as the one before.
[[gnu::always_inline]] inline void Cpu::waitIf(Pc& pc, bool is_taken) {
  jumpIf(pc, is_taken);
  if (pc == began_at_) passOver(wholeTurns());
}

/// DJNZ. One that leads to itself is a delay, whose turns differ in the count alone.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeDecrement(Pc& pc) {
  if constexpr (kOpcode == 0xD5) {
    const std::uint8_t address = operand(pc);
    const auto value = static_cast<std::uint8_t>(readDirect(address, true) - 1);
    writeDirect(address, value);
    jumpIf(pc, value != 0);
  } else {
    auto& byte = registerOf(kOpcode);
    byte = static_cast<std::uint8_t>(byte - 1);
    jumpIf(pc, byte != 0);
    if (pc != began_at_) return;
    const std::uint64_t turns = std::min<std::uint64_t>(byte - 1U, wholeTurns());
    byte = static_cast<std::uint8_t>(byte - turns);
    passOver(turns);
  }
}

/// AJMP and ACALL: the upper three bits of the opcode are those of an address inside the 2 KiB that the next
/// instruction lies in.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeJump(Pc& pc) {
  const unsigned low = operand(pc);
  const auto target = static_cast<std::uint16_t>((pc & 0xF800U) | (kOpcode & 0xE0U) << 3U | low);
  if constexpr ((kOpcode & 0x10U) != 0) {
    pushPc(pc, target);
  } else {
    pc = target;
  }
}

[[gnu::always_inline]] inline void Cpu::compare(Pc& pc, std::uint8_t left, std::uint8_t right) {
  setCarry(left < right);
  jumpIf(pc, left != right);
}

/// CJNE: row B.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeCompare(Pc& pc) {
  if constexpr ((kOpcode & 0xFU) < 6) {
    compare(pc, acc(), source<kOpcode>(pc));
  } else {
    const std::uint8_t left = registerOrIndirect(kOpcode);
    compare(pc, left, operand(pc));
  }
}

template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeBitJump(Pc& pc) {
  const std::uint8_t bit = operand(pc);
  if constexpr (kOpcode == 0x10) {  // JBC
    const bool is_set = readBit(bit, true);
    if (is_set) writeBit(bit, false);
    jumpIf(pc, is_set);
  } else {
    waitIf(pc, readBit(bit) == (kOpcode == 0x20));
  }
}

/// MOVX, MOVC and DPTR.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeMemory(Pc& pc) {
  // Port 2 gives the upper half of an address on the bus; the STC15's RAM on the chip has none by R0 and R1.
  const auto by_register = [this] {
    const unsigned page = part_.is_stc15 ? 0 : sfrs_[kP2];
    return static_cast<std::uint16_t>(page << 8U | registerOf(kOpcode & 1U));
  };
  if constexpr (kOpcode == 0x83) {
    acc() = code_[(pc + acc()) & 0xFFFFU];
  } else if constexpr (kOpcode == 0x93) {
    acc() = code_[(unsigned{dptr()} + acc()) & 0xFFFFU];
  } else if constexpr (kOpcode == 0x90) {
    setDptr(wordOperand(pc));
  } else if constexpr (kOpcode == 0xA3) {
    setDptr(static_cast<std::uint16_t>(dptr() + 1U));
  } else if constexpr (kOpcode == 0xE0) {
    acc() = readXram(dptr());
  } else if constexpr (kOpcode == 0xF0) {
    writeXram(dptr(), acc());
  } else if constexpr (kOpcode == 0xE2 || kOpcode == 0xE3) {
    acc() = readXram(by_register());
  } else {
    static_assert(kOpcode == 0xF2 || kOpcode == 0xF3);
    writeXram(by_register(), acc());
  }
}

[[gnu::always_inline]] inline void Cpu::pushPc(Pc& pc, std::uint16_t target) {
  push(static_cast<std::uint8_t>(pc));
  push(static_cast<std::uint8_t>(pc >> 8U));
  pc = target;
}

[[gnu::always_inline]] inline void Cpu::ret(Pc& pc) {
  const unsigned high = pop();
  pc = high << 8U | pop();
}

/// Columns 0, 2 and 3.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeOther(Pc& pc) {
  constexpr bool kIsOnMemory = kOpcode == 0x83 || kOpcode == 0x90 || kOpcode == 0x93 || kOpcode == 0xA3 ||
                               kOpcode == 0xE0 || kOpcode == 0xE2 || kOpcode == 0xE3 || kOpcode == 0xF0 ||
                               kOpcode == 0xF2 || kOpcode == 0xF3;
  constexpr bool kIsLogic = (kOpcode & 0xEU) == 2 && kOpcode >= 0x40 && kOpcode < 0x70;
  if constexpr (kIsOnMemory) {
    executeMemory<kOpcode>(pc);
  } else if constexpr (kIsLogic) {
    executeLogicOnDirect<kOpcode>(pc);
  } else if constexpr ((kOpcode & 0xFU) == 3 && kOpcode < 0x40) {
    executeAccumulator<kOpcode>();
  } else if constexpr (kOpcode == 0x10 || kOpcode == 0x20 || kOpcode == 0x30) {
    executeBitJump<kOpcode>(pc);
  } else if constexpr (kOpcode == 0x02) {
    pc = wordOperand(pc);
  } else if constexpr (kOpcode == 0x12) {
    pushPc(pc, wordOperand(pc));
  } else if constexpr (kOpcode == 0x22) {
    ret(pc);
  } else if constexpr (kOpcode == 0x32) {
    ret(pc);
    has_returned_ = true;
    attend(0);
  } else if constexpr (kOpcode == 0x40 || kOpcode == 0x50) {
    jumpIf(pc, carry() == (kOpcode == 0x40));
  } else if constexpr (kOpcode == 0x60 || kOpcode == 0x70) {
    jumpIf(pc, (acc() == 0) == (kOpcode == 0x60));
  } else if constexpr (kOpcode == 0x80) {
    waitIf(pc, true);
  } else if constexpr (kOpcode == 0x73) {
    pc = (unsigned{dptr()} + acc()) & 0xFFFFU;
  } else if constexpr (kOpcode == 0xC0) {  // The stack pointer is incremented first, as PUSH SP shows.
    const std::uint8_t address = operand(pc);
    push(0);
    iram_[sfrs_[kSp]] = readDirect(address);
  } else if constexpr (kOpcode == 0xD0) {
    const std::uint8_t address = operand(pc);
    writeDirect(address, pop());
  } else if constexpr (kOpcode != 0x00) {
    executeBit<kOpcode>(pc);
  }
}

}  // namespace kerfbench::mcs51_child
