// SPDX-License-Identifier: Apache-2.0
// Jumps, calls, and what columns 0 to 3 have besides.
#include "hil/source/mcs51_child/cpu.h"

namespace kerfbench::mcs51_child {

/// A relative jump, from the address behind its operand.
void Cpu::jumpIf(bool is_taken) {
  const auto distance = static_cast<std::int8_t>(operand());
  if (is_taken) pc_ = static_cast<std::uint16_t>(static_cast<int>(pc_) + distance);
}

/// AJMP and ACALL: the upper three bits of the opcode are those of an address inside the 2 KiB that the next
/// instruction lies in.
void Cpu::executeJump(std::uint8_t opcode) {
  const unsigned low = operand();
  const auto target = static_cast<std::uint16_t>((pc_ & 0xF800U) | (opcode & 0xE0U) << 3U | low);
  if ((opcode & 0x10U) != 0) {
    call(target);
  } else {
    pc_ = target;
  }
}

void Cpu::compare(std::uint8_t left, std::uint8_t right) {
  setCarry(left < right);
  jumpIf(left != right);
}

/// CJNE: row B.
void Cpu::executeCompare(std::uint8_t opcode) {
  const unsigned column = opcode & 0xFU;
  if (column < 6) {
    compare(acc(), source(opcode));
  } else {
    const std::uint8_t left = registerOrIndirect(opcode);
    compare(left, operand());
  }
}

void Cpu::executeBitJump(std::uint8_t opcode) {
  const std::uint8_t bit = operand();
  switch (opcode) {
    case 0x10: {  // JBC
      const bool is_set = readBit(bit, true);
      if (is_set) writeBit(bit, false);
      jumpIf(is_set);
      break;
    }
    case 0x20:
      jumpIf(readBit(bit));
      break;
    default:
      jumpIf(!readBit(bit));
  }
}

/// MOVX, MOVC and DPTR.
void Cpu::executeMemory(std::uint8_t opcode) {
  // Port 2 gives the upper half of an address on the bus; the STC15's RAM on the chip has none by R0 and R1.
  const auto by_register = [this](std::uint8_t from) {
    const unsigned page = part_.is_stc15 ? 0 : sfrs_[kP2];
    return static_cast<std::uint16_t>(page << 8U | registerOf(from & 1U));
  };
  switch (opcode) {
    case 0x83:
      acc() = code((pc_ + acc()) & 0xFFFFU);
      break;
    case 0x93:
      acc() = code((unsigned{dptr()} + acc()) & 0xFFFFU);
      break;
    case 0x90:
      setDptr(wordOperand());
      break;
    case 0xA3:
      setDptr(static_cast<std::uint16_t>(dptr() + 1U));
      break;
    case 0xE0:
      acc() = readXram(dptr());
      break;
    case 0xE2:
    case 0xE3:
      acc() = readXram(by_register(opcode));
      break;
    case 0xF0:
      writeXram(dptr(), acc());
      break;
    default:
      writeXram(by_register(opcode), acc());
  }
}

/// Columns 0, 2 and 3.
void Cpu::executeOther(std::uint8_t opcode) {
  switch (opcode) {
    case 0x00:
      break;
    case 0x02:
      pc_ = wordOperand();
      break;
    case 0x12:
      call(wordOperand());
      break;
    case 0x03:
    case 0x13:
    case 0x23:
    case 0x33:
      executeAccumulator(opcode);
      break;
    case 0x10:
    case 0x20:
    case 0x30:
      executeBitJump(opcode);
      break;
    case 0x22:
    case 0x32: {
      const unsigned high = pop();
      pc_ = high << 8U | pop();
      has_returned_ = opcode == 0x32;
      break;
    }
    case 0x40:
      jumpIf(carry());
      break;
    case 0x50:
      jumpIf(!carry());
      break;
    case 0x60:
      jumpIf(acc() == 0);
      break;
    case 0x70:
      jumpIf(acc() != 0);
      break;
    case 0x80:
      jumpIf(true);
      break;
    case 0x73:
      pc_ = (unsigned{dptr()} + acc()) & 0xFFFFU;
      break;
    case 0xC0: {  // The stack pointer is incremented first, as PUSH SP shows.
      const std::uint8_t address = operand();
      push(0);
      iram_[sfrs_[kSp]] = readDirect(address);
      break;
    }
    case 0xD0: {
      const std::uint8_t address = operand();
      writeDirect(address, pop());
      break;
    }
    default:
      executeOnMemoryOrBits(opcode);
  }
}

void Cpu::executeOnMemoryOrBits(std::uint8_t opcode) {
  switch (opcode) {
    case 0x42:
    case 0x43:
    case 0x52:
    case 0x53:
    case 0x62:
    case 0x63:
      executeLogicOnDirect(opcode);
      break;
    case 0x83:
    case 0x90:
    case 0x93:
    case 0xA3:
    case 0xE0:
    case 0xE2:
    case 0xE3:
    case 0xF0:
    case 0xF2:
    case 0xF3:
      executeMemory(opcode);
      break;
    default:
      executeBit(opcode);
  }
}

}  // namespace kerfbench::mcs51_child
