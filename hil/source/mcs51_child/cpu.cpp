// SPDX-License-Identifier: Apache-2.0
// Registers and memories; the instructions are in instructions.cpp and jumps.cpp.
#include "hil/source/mcs51_child/cpu.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <utility>

namespace kerfbench::mcs51_child {

constexpr std::size_t kCodeBytes = 65536 + 3;

Cpu::Cpu(const Part& part, Sfrs& sfrs, Peripherals& peripherals)
    : part_(part),
      clocks_(part.clocks()),
      sfrs_(sfrs),
      peripherals_(peripherals),
      iram_bytes_(part.iram_bytes),
      code_(kCodeBytes, 0xFF),
      xram_(part.xram_bytes, 0) {}

/// Where no memory is, 0xFF is read, and the opcode that is not defined stands.
void Cpu::load(const std::vector<std::uint8_t>& code) { std::ranges::copy(code, code_.begin()); }

void Cpu::reset() {
  pc_ = 0;
  has_returned_ = false;
  selectBank();
}

void Cpu::setFault(const std::string& what) {
  attend(0);
  if (!fault_.empty()) return;
  char where[32];
  std::snprintf(where, sizeof where, " at address 0x%04x", static_cast<unsigned>(began_at_));
  fault_ = what + where;
}

std::uint8_t Cpu::psw() const {
  const auto parity = static_cast<unsigned>(std::popcount(sfrs_[kAcc])) & 1U;
  return static_cast<std::uint8_t>((sfrs_[kPsw] & ~unsigned{kParity}) | parity);
}

std::uint8_t Cpu::readSfr(std::uint8_t address, bool is_latch) {
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

void Cpu::writeSfr(std::uint8_t address, std::uint8_t value) {
  switch (address) {
    case kPsw:
      sfrs_[kPsw] = value;
      selectBank();
      break;
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

void Cpu::writeSfrBit(std::uint8_t address, std::uint8_t mask, bool on) {
  if (address == kPsw || address == kAcc || address == kB) {
    sfrs_.set(address, mask, on);
    selectBank();
  } else {
    peripherals_.writeSfrBit(address, mask, on);
  }
}

void Cpu::call(std::uint16_t vector) {
  push(static_cast<std::uint8_t>(pc_));
  push(static_cast<std::uint8_t>(pc_ >> 8U));
  pc_ = vector;
}

}  // namespace kerfbench::mcs51_child
