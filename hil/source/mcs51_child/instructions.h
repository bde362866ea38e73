// SPDX-License-Identifier: Apache-2.0
#pragma once

// Arithmetic, logic, moves and bits. An opcode's low digit, its column, says what its operand is: 4 a byte
// of its own, 5 a direct address, 6 and 7 what R0 or R1 points at, 8 to F a register (Intel 1994, chapter 2).
// Opcodes are parameters of templates, so that each instruction becomes a function in which nothing is left
// to be decoded; run.cpp alone includes this.
#include "hil/source/mcs51_child/cpu.h"

namespace kerfbench::mcs51_child {

/// The source operand by the column of the opcode: immediate, direct, indirect or a register.
template <unsigned kOpcode>
[[gnu::always_inline]] inline std::uint8_t Cpu::source(Pc& pc) {
  constexpr unsigned kColumn = kOpcode & 0xFU;
  if constexpr (kColumn == 4) {
    return operand(pc);
  } else if constexpr (kColumn == 5) {
    return readDirect(operand(pc));
  } else {
    return registerOrIndirect(kOpcode);
  }
}

/// INC in row 0 and DEC in row 1.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::step(Pc& pc) {
  constexpr unsigned kBy = kOpcode < 0x10 ? 1 : 0xFF;
  constexpr unsigned kColumn = kOpcode & 0xFU;
  if constexpr (kColumn == 4) {
    acc() = static_cast<std::uint8_t>(acc() + kBy);
  } else if constexpr (kColumn == 5) {
    const std::uint8_t address = operand(pc);
    writeDirect(address, static_cast<std::uint8_t>(readDirect(address, true) + kBy));
  } else {
    auto& byte = registerOrIndirect(kOpcode);
    byte = static_cast<std::uint8_t>(byte + kBy);
  }
}

template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeArithmetic(Pc& pc) {
  constexpr unsigned kRow = kOpcode >> 4U;
  const std::uint8_t value = source<kOpcode>(pc);
  if constexpr (kRow == 0x2) {
    add(value, false);
  } else if constexpr (kRow == 0x3) {
    add(value, carry());
  } else if constexpr (kRow == 0x4) {
    acc() |= value;
  } else if constexpr (kRow == 0x5) {
    acc() &= value;
  } else if constexpr (kRow == 0x6) {
    acc() ^= value;
  } else {
    subtract(value);
  }
}

[[gnu::always_inline]] inline void Cpu::add(std::uint8_t value, bool carry_in) {
  const unsigned a = acc();
  const unsigned in = carry_in ? 1 : 0;
  const unsigned sum = a + value + in;
  // The auxiliary carry is that into bit 4, and an overflow is a carry into bit 7 without one out of it.
  const unsigned carried = a ^ value ^ sum;
  setFlags((sum >> 8U & 1U) << 7U | (carried >> 4U & 1U) << 6U |
           ((carried >> 7U ^ carried >> 8U) & 1U) << 2U);
  acc() = static_cast<std::uint8_t>(sum);
}

[[gnu::always_inline]] inline void Cpu::subtract(std::uint8_t value) {
  const unsigned a = acc();
  const unsigned borrow = carry() ? 1 : 0;
  const unsigned difference = a - value - borrow;
  const unsigned borrowed = a ^ value ^ difference;
  setFlags((difference >> 8U & 1U) << 7U | (borrowed >> 4U & 1U) << 6U |
           ((borrowed >> 7U ^ borrowed >> 8U) & 1U) << 2U);
  acc() = static_cast<std::uint8_t>(difference);
}

[[gnu::always_inline]] inline void Cpu::multiply() {
  const unsigned product = unsigned{acc()} * bRegister();
  acc() = static_cast<std::uint8_t>(product);
  bRegister() = static_cast<std::uint8_t>(product >> 8U);
  setCarry(false);
  sfrs_.set(kPsw, kOverflow, product > 0xFF);
}

/// A division by zero leaves A and B undefined, says Intel; here they stay.
[[gnu::always_inline]] inline void Cpu::divide() {
  const std::uint8_t divisor = bRegister();
  setCarry(false);
  sfrs_.set(kPsw, kOverflow, divisor == 0);
  if (divisor == 0) return;
  bRegister() = static_cast<std::uint8_t>(acc() % divisor);
  acc() = static_cast<std::uint8_t>(acc() / divisor);
}

/// DA A: the carry is set and never cleared.
[[gnu::always_inline]] inline void Cpu::adjustDecimal() {
  unsigned a = acc();
  if ((a & 0xFU) > 9 || (sfrs_[kPsw] & kAuxiliaryCarry) != 0) a += 6;
  if (a > 0xFF) setCarry(true);
  if ((a >> 4U & 0xFU) > 9 || a > 0xFF || carry()) a += 0x60;
  if (a > 0xFF) setCarry(true);
  acc() = static_cast<std::uint8_t>(a);
}

template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeAccumulator() {
  const unsigned a = acc();
  if constexpr (kOpcode == 0x84) {
    divide();
  } else if constexpr (kOpcode == 0xA4) {
    multiply();
  } else if constexpr (kOpcode == 0x03) {  // RR
    acc() = static_cast<std::uint8_t>(a >> 1U | a << 7U);
  } else if constexpr (kOpcode == 0x13) {  // RRC
    acc() = static_cast<std::uint8_t>(a >> 1U | (carry() ? 0x80U : 0U));
    setCarry((a & 1U) != 0);
  } else if constexpr (kOpcode == 0x23) {  // RL
    acc() = static_cast<std::uint8_t>(a << 1U | a >> 7U);
  } else {  // RLC
    acc() = static_cast<std::uint8_t>(a << 1U | (carry() ? 1U : 0U));
    setCarry((a & 0x80U) != 0);
  }
}

/// MOV without A as its destination, in rows 7, 8, A and F, and CPL A.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeMove(Pc& pc) {
  constexpr unsigned kRow = kOpcode >> 4U;
  constexpr unsigned kColumn = kOpcode & 0xFU;
  if constexpr (kOpcode == 0xA5) {
    setFault("the undefined opcode 0xa5");
  } else if constexpr (kOpcode == 0xF4) {
    acc() = static_cast<std::uint8_t>(~acc());
  } else if constexpr (kOpcode == 0x74) {
    acc() = operand(pc);
  } else if constexpr (kRow == 0x8) {
    const std::uint8_t value = source<kOpcode>(pc);
    writeDirect(operand(pc), value);
  } else if constexpr (kRow == 0xA) {
    const std::uint8_t value = readDirect(operand(pc));
    registerOrIndirect(kOpcode) = value;
  } else if constexpr (kColumn == 5) {
    const std::uint8_t address = operand(pc);
    writeDirect(address, kRow == 0x7 ? operand(pc) : acc());
  } else {
    const std::uint8_t value = kRow == 0x7 ? operand(pc) : acc();
    registerOrIndirect(kOpcode) = value;
  }
}

/// SWAP, XCH, DA, XCHD and DJNZ: rows C and D.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeExchange(Pc& pc) {
  constexpr bool kIsRowC = kOpcode >> 4U == 0xC;
  constexpr unsigned kColumn = kOpcode & 0xFU;
  if constexpr (kOpcode == 0xC4) {
    acc() = static_cast<std::uint8_t>(unsigned{acc()} << 4U | unsigned{acc()} >> 4U);
  } else if constexpr (kOpcode == 0xD4) {
    adjustDecimal();
  } else if constexpr (kOpcode == 0xC5) {
    const std::uint8_t address = operand(pc);
    const std::uint8_t value = readDirect(address);
    writeDirect(address, acc());
    acc() = value;
  } else if constexpr (kIsRowC) {
    std::swap(acc(), registerOrIndirect(kOpcode));
  } else if constexpr (kColumn == 6 || kColumn == 7) {
    auto& byte = registerOrIndirect(kOpcode);
    const std::uint8_t value = byte;
    byte = static_cast<std::uint8_t>((byte & 0xF0U) | (acc() & 0x0FU));
    acc() = static_cast<std::uint8_t>((acc() & 0xF0U) | (value & 0x0FU));
  } else {
    executeDecrement<kOpcode>(pc);
  }
}

/// ORL, ANL and XRL on a direct address: with A in column 2, with a byte of their own in column 3.
template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeLogicOnDirect(Pc& pc) {
  constexpr unsigned kRow = kOpcode >> 4U;
  const std::uint8_t address = operand(pc);
  const unsigned value = (kOpcode & 0xFU) == 2 ? acc() : operand(pc);
  const unsigned old = readDirect(address, true);
  const unsigned result = kRow == 4 ? old | value : kRow == 5 ? old & value : old ^ value;
  writeDirect(address, static_cast<std::uint8_t>(result));
}

template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::executeBit(Pc& pc) {
  if constexpr (kOpcode == 0x72) {
    setCarry(readBit(operand(pc)) || carry());
  } else if constexpr (kOpcode == 0x82) {
    setCarry(readBit(operand(pc)) && carry());
  } else if constexpr (kOpcode == 0xA0) {
    setCarry(!readBit(operand(pc)) || carry());
  } else if constexpr (kOpcode == 0xB0) {
    setCarry(!readBit(operand(pc)) && carry());
  } else if constexpr (kOpcode == 0xA2) {
    setCarry(readBit(operand(pc)));
  } else if constexpr (kOpcode == 0x92) {
    writeBit(operand(pc), carry());
  } else if constexpr (kOpcode == 0xB2) {
    const std::uint8_t bit = operand(pc);
    writeBit(bit, !readBit(bit, true));
  } else if constexpr (kOpcode == 0xC2 || kOpcode == 0xD2) {
    writeBit(operand(pc), kOpcode == 0xD2);
  } else if constexpr (kOpcode == 0xB3) {
    setCarry(!carry());
  } else {
    static_assert(kOpcode == 0xC3 || kOpcode == 0xD3);  // CLR C and SETB C
    setCarry(kOpcode == 0xD3);
  }
}

}  // namespace kerfbench::mcs51_child
