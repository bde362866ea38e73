// SPDX-License-Identifier: Apache-2.0
// Arithmetic, logic, moves and bits. An opcode's low digit, its column, says what its operand is: 4 a byte
// of its own, 5 a direct address, 6 and 7 what R0 or R1 points at, 8 to F a register (Intel 1994, chapter 2).
#include "hil/source/mcs51_child/cpu.h"

namespace kerfbench::mcs51_child {

void Cpu::execute(std::uint8_t opcode) {
  const unsigned column = opcode & 0xFU;
  if (column == 1) {
    executeJump(opcode);
    return;
  }
  if (column < 4) {
    executeOther(opcode);
    return;
  }
  switch (opcode >> 4U) {
    case 0x0:
      step(opcode, 1);
      break;
    case 0x1:
      step(opcode, 0xFF);
      break;
    case 0x7:
    case 0x8:
    case 0xA:
      if (column == 4 && opcode != 0x74) {
        executeAccumulator(opcode);
      } else {
        executeMove(opcode);
      }
      break;
    case 0xB:
      executeCompare(opcode);
      break;
    case 0xC:
    case 0xD:
      executeExchange(opcode);
      break;
    case 0xE:
      acc() = column == 4 ? std::uint8_t{0} : source(opcode);
      break;
    case 0xF:
      executeMove(opcode);
      break;
    default:
      executeArithmetic(opcode);
  }
}

/// INC and DEC.
void Cpu::step(std::uint8_t opcode, std::uint8_t by) {
  const auto stepped = [by](std::uint8_t value) { return static_cast<std::uint8_t>(value + by); };
  switch (opcode & 0xFU) {
    case 4:
      acc() = stepped(acc());
      break;
    case 5: {
      const std::uint8_t address = operand();
      writeDirect(address, stepped(readDirect(address, true)));
      break;
    }
    default: {
      auto& byte = registerOrIndirect(opcode);
      byte = stepped(byte);
    }
  }
}

void Cpu::executeArithmetic(std::uint8_t opcode) {
  const std::uint8_t value = source(opcode);
  switch (opcode >> 4U) {
    case 0x2:
      add(value, false);
      break;
    case 0x3:
      add(value, carry());
      break;
    case 0x4:
      acc() |= value;
      break;
    case 0x5:
      acc() &= value;
      break;
    case 0x6:
      acc() ^= value;
      break;
    default:
      subtract(value);
  }
}

void Cpu::add(std::uint8_t value, bool carry_in) {
  const unsigned a = acc();
  const unsigned in = carry_in ? 1 : 0;
  const unsigned sum = a + value + in;
  setFlags(sum > 0xFF, (a & 0xFU) + (value & 0xFU) + in > 0xF, (~(a ^ value) & (a ^ sum) & 0x80U) != 0);
  acc() = static_cast<std::uint8_t>(sum);
}

void Cpu::subtract(std::uint8_t value) {
  const unsigned a = acc();
  const unsigned borrow = carry() ? 1 : 0;
  const unsigned difference = a - value - borrow;
  setFlags(a < value + borrow, (a & 0xFU) < (value & 0xFU) + borrow,
           ((a ^ value) & (a ^ difference) & 0x80U) != 0);
  acc() = static_cast<std::uint8_t>(difference);
}

void Cpu::multiply() {
  const unsigned product = unsigned{acc()} * bRegister();
  acc() = static_cast<std::uint8_t>(product);
  bRegister() = static_cast<std::uint8_t>(product >> 8U);
  setCarry(false);
  sfrs_.set(kPsw, kOverflow, product > 0xFF);
}

/// A division by zero leaves A and B undefined, says Intel; here they stay.
void Cpu::divide() {
  const std::uint8_t divisor = bRegister();
  setCarry(false);
  sfrs_.set(kPsw, kOverflow, divisor == 0);
  if (divisor == 0) return;
  bRegister() = static_cast<std::uint8_t>(acc() % divisor);
  acc() = static_cast<std::uint8_t>(acc() / divisor);
}

/// DA A: the carry is set and never cleared.
void Cpu::adjustDecimal() {
  unsigned a = acc();
  if ((a & 0xFU) > 9 || (sfrs_[kPsw] & kAuxiliaryCarry) != 0) a += 6;
  if (a > 0xFF) setCarry(true);
  if ((a >> 4U & 0xFU) > 9 || a > 0xFF || carry()) a += 0x60;
  if (a > 0xFF) setCarry(true);
  acc() = static_cast<std::uint8_t>(a);
}

void Cpu::executeAccumulator(std::uint8_t opcode) {
  switch (opcode) {
    case 0x84:
      divide();
      break;
    case 0xA4:
      multiply();
      break;
    case 0x03:  // RR
      acc() = static_cast<std::uint8_t>(unsigned{acc()} >> 1U | unsigned{acc()} << 7U);
      break;
    case 0x13: {  // RRC
      const bool out = (acc() & 1U) != 0;
      acc() = static_cast<std::uint8_t>(acc() >> 1U | (carry() ? 0x80U : 0U));
      setCarry(out);
      break;
    }
    case 0x23:  // RL
      acc() = static_cast<std::uint8_t>(unsigned{acc()} << 1U | unsigned{acc()} >> 7U);
      break;
    default: {  // RLC
      const bool out = (acc() & 0x80U) != 0;
      acc() = static_cast<std::uint8_t>(unsigned{acc()} << 1U | (carry() ? 1U : 0U));
      setCarry(out);
    }
  }
}

/// MOV without A as its destination, in rows 7, 8, A and F, and CPL A.
void Cpu::executeMove(std::uint8_t opcode) {
  const unsigned row = opcode >> 4U;
  const unsigned column = opcode & 0xFU;
  if (opcode == 0xA5) {
    setFault("the undefined opcode 0xa5");
  } else if (row == 0x7 || row == 0xF) {
    if (opcode == 0xF4) {
      acc() = static_cast<std::uint8_t>(~acc());
    } else if (opcode == 0x74) {
      acc() = operand();
    } else if (column == 5) {
      const std::uint8_t address = operand();
      writeDirect(address, row == 0x7 ? operand() : acc());
    } else {
      const std::uint8_t value = row == 0x7 ? operand() : acc();
      registerOrIndirect(opcode) = value;
    }
  } else if (row == 0x8) {
    const std::uint8_t value = column == 5 ? readDirect(operand()) : registerOrIndirect(opcode);
    writeDirect(operand(), value);
  } else {
    const std::uint8_t value = readDirect(operand());
    registerOrIndirect(opcode) = value;
  }
}

/// SWAP, XCH, DA, XCHD and DJNZ: rows C and D.
void Cpu::executeExchange(std::uint8_t opcode) {
  const bool is_row_c = opcode >> 4U == 0xC;
  const unsigned column = opcode & 0xFU;
  if (column == 4) {
    if (is_row_c) {
      acc() = static_cast<std::uint8_t>(unsigned{acc()} << 4U | unsigned{acc()} >> 4U);
    } else {
      adjustDecimal();
    }
  } else if (column == 5) {
    const std::uint8_t address = operand();
    if (is_row_c) {
      const std::uint8_t value = readDirect(address);
      writeDirect(address, acc());
      acc() = value;
    } else {
      const auto value = static_cast<std::uint8_t>(readDirect(address, true) - 1);
      writeDirect(address, value);
      jumpIf(value != 0);
    }
  } else if (is_row_c) {
    std::swap(acc(), registerOrIndirect(opcode));
  } else if (column < 8) {
    auto& byte = registerOrIndirect(opcode);
    const std::uint8_t value = byte;
    byte = static_cast<std::uint8_t>((byte & 0xF0U) | (acc() & 0x0FU));
    acc() = static_cast<std::uint8_t>((acc() & 0xF0U) | (value & 0x0FU));
  } else {
    auto& byte = registerOf(opcode);
    byte = static_cast<std::uint8_t>(byte - 1);
    jumpIf(byte != 0);
  }
}

/// ORL, ANL and XRL on a direct address: with A in column 2, with a byte of their own in column 3.
void Cpu::executeLogicOnDirect(std::uint8_t opcode) {
  const std::uint8_t address = operand();
  const unsigned value = (opcode & 0xFU) == 2 ? acc() : operand();
  const unsigned old = readDirect(address, true);
  const unsigned row = opcode >> 4U;
  const unsigned result = row == 4 ? old | value : row == 5 ? old & value : old ^ value;
  writeDirect(address, static_cast<std::uint8_t>(result));
}

void Cpu::executeBit(std::uint8_t opcode) {
  switch (opcode) {
    case 0x72:
      setCarry(readBit(operand()) || carry());
      break;
    case 0x82:
      setCarry(readBit(operand()) && carry());
      break;
    case 0xA0:
      setCarry(!readBit(operand()) || carry());
      break;
    case 0xB0:
      setCarry(!readBit(operand()) && carry());
      break;
    case 0xA2:
      setCarry(readBit(operand()));
      break;
    case 0x92:
      writeBit(operand(), carry());
      break;
    case 0xB2: {
      const std::uint8_t bit = operand();
      writeBit(bit, !readBit(bit, true));
      break;
    }
    case 0xC2:
      writeBit(operand(), false);
      break;
    case 0xD2:
      writeBit(operand(), true);
      break;
    case 0xB3:
      setCarry(!carry());
      break;
    default:  // CLR C and SETB C: 0xC3, 0xD3
      setCarry(opcode == 0xD3);
  }
}

}  // namespace kerfbench::mcs51_child
