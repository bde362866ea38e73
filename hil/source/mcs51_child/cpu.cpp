// SPDX-License-Identifier: Apache-2.0
// Registers and memories; the instructions are in instructions.cpp and jumps.cpp.
#include "hil/source/mcs51_child/cpu.h"

#include <bit>
#include <cstdio>
#include <utility>

namespace kerfbench::mcs51_child {

Cpu::Cpu(const Part& part, Sfrs& sfrs, Peripherals& peripherals)
    : part_(part),
      sfrs_(sfrs),
      peripherals_(peripherals),
      code_(part.code_bytes, 0xFF),
      xram_(part.xram_bytes, 0) {}

void Cpu::reset() {
  pc_ = 0;
  has_returned_ = false;
}

void Cpu::setFault(const std::string& what) {
  if (!fault_.empty()) return;
  char where[32];
  std::snprintf(where, sizeof where, " at address 0x%04x", static_cast<unsigned>(began_at_));
  fault_ = what + where;
}

std::uint16_t Cpu::wordOperand() {
  const unsigned high = operand();
  return static_cast<std::uint16_t>(high << 8U | operand());
}

std::uint8_t Cpu::psw() const {
  const auto parity = static_cast<unsigned>(std::popcount(sfrs_[kAcc])) & 1U;
  return static_cast<std::uint8_t>((sfrs_[kPsw] & ~unsigned{kParity}) | parity);
}

std::uint8_t Cpu::readDirect(std::uint8_t address, bool is_latch) {
  if (address < 0x80) return iram_[address];
  switch (address) {
    case kPsw:
      return psw();
    case kAcc:
    case kB:
    case kSp:
    case kDpl:
    case kDph:
      return sfrs_[address];
    default:
      return peripherals_.readSfr(address, is_latch);
  }
}

void Cpu::writeDirect(std::uint8_t address, std::uint8_t value) {
  if (address < 0x80) {
    iram_[address] = value;
    return;
  }
  switch (address) {
    case kPsw:
    case kAcc:
    case kB:
    case kSp:
    case kDpl:
    case kDph:
      sfrs_[address] = value;
      break;
    default:
      peripherals_.writeSfr(address, value);
  }
}

/// The source operand by the column of the opcode: immediate, direct, indirect or a register.
std::uint8_t Cpu::source(std::uint8_t opcode) {
  switch (opcode & 0xFU) {
    case 4:
      return operand();
    case 5:
      return readDirect(operand());
    default:
      return registerOrIndirect(opcode);
  }
}

bool Cpu::readBit(std::uint8_t bit, bool is_latch) {
  const auto address = static_cast<std::uint8_t>(bit < 0x80 ? 0x20 + (bit >> 3U) : bit & 0xF8U);
  return (readDirect(address, is_latch) >> (bit & 7U) & 1U) != 0;
}

void Cpu::writeBit(std::uint8_t bit, bool on) {
  const auto address = static_cast<std::uint8_t>(bit < 0x80 ? 0x20 + (bit >> 3U) : bit & 0xF8U);
  const auto mask = static_cast<std::uint8_t>(1U << (bit & 7U));
  if (bit < 0x80) {
    iram_[address] = static_cast<std::uint8_t>(on ? iram_[address] | mask : iram_[address] & ~mask);
  } else if (address == kPsw || address == kAcc || address == kB) {
    sfrs_.set(address, mask, on);
  } else {
    peripherals_.writeSfrBit(address, mask, on);
  }
}

std::uint8_t Cpu::readXram(std::uint16_t address) {
  if (address < xram_.size()) return xram_[address];
  setFault("MOVX reaches beyond the external RAM");
  return 0xFF;
}

void Cpu::writeXram(std::uint16_t address, std::uint8_t value) {
  if (address < xram_.size()) {
    xram_[address] = value;
  } else {
    setFault("MOVX reaches beyond the external RAM");
  }
}

void Cpu::push(std::uint8_t value) {
  auto& sp = sfrs_[kSp];
  sp = static_cast<std::uint8_t>(sp + 1);
  if (sp == 0 || sp >= part_.iram_bytes) setFault("the stack grew beyond the internal RAM");
  iram_[sp] = value;
}

std::uint8_t Cpu::pop() {
  auto& sp = sfrs_[kSp];
  const std::uint8_t value = iram_[sp];
  if (sp == 0) setFault("more was taken from the stack than was put there");
  sp = static_cast<std::uint8_t>(sp - 1);
  return value;
}

void Cpu::call(std::uint16_t vector) {
  push(static_cast<std::uint8_t>(pc_));
  push(static_cast<std::uint8_t>(pc_ >> 8U));
  pc_ = vector;
}

std::uint16_t Cpu::dptr() const {
  const bool second = usesSecondDptr();
  return static_cast<std::uint16_t>(sfrs_[second ? kDp1h : kDph] << 8 | sfrs_[second ? kDp1l : kDpl]);
}

void Cpu::setDptr(std::uint16_t value) {
  const bool second = usesSecondDptr();
  sfrs_[second ? kDp1h : kDph] = static_cast<std::uint8_t>(value >> 8U);
  sfrs_[second ? kDp1l : kDpl] = static_cast<std::uint8_t>(value);
}

}  // namespace kerfbench::mcs51_child
