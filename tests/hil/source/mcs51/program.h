// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "hil/source/mcs51_child/chip.h"

namespace kerfbench::mcs51_child {

/// Addresses of bits.
inline constexpr std::uint8_t kP1_0 = 0x90, kP1_1 = 0x91, kP1_2 = 0x92, kP1_3 = 0x93, kP3_2 = 0xB2,
                              kP3_4 = 0xB4, kIt0 = 0x88, kIe0 = 0x89, kTr0 = 0x8C, kTf0 = 0x8D, kTr1 = 0x8E,
                              kTf1 = 0x8F, kRiBit = 0x98, kTiBit = 0x99, kTr2Bit = 0xCA, kTf2Bit = 0xCF,
                              kExf2Bit = 0xCE, kEaBit = 0xAF;

/// A small program put together by hand, instruction by instruction.
class Program {
 public:
  Program& at(unsigned address) {
    if (code_.size() < address) code_.resize(address, 0);
    at_ = address;
    return *this;
  }
  [[nodiscard]] unsigned here() const { return at_; }
  Program& put(std::initializer_list<unsigned> bytes) {
    if (code_.size() < at_ + bytes.size()) code_.resize(at_ + bytes.size(), 0);
    for (const unsigned byte : bytes) code_[at_++] = static_cast<std::uint8_t>(byte);
    return *this;
  }
  Program& nop(unsigned count = 1) {
    for (unsigned i = 0; i < count; ++i) put({0x00});
    return *this;
  }
  Program& mov(std::uint8_t direct, unsigned value) { return put({0x75, direct, value}); }
  Program& movDirect(std::uint8_t to, std::uint8_t from) { return put({0x85, from, to}); }
  Program& movA(unsigned value) { return put({0x74, value}); }
  Program& setb(std::uint8_t bit) { return put({0xD2, bit}); }
  Program& clr(std::uint8_t bit) { return put({0xC2, bit}); }
  Program& cpl(std::uint8_t bit) { return put({0xB2, bit}); }
  Program& ljmp(unsigned target) { return put({0x02, target >> 8U, target & 0xFFU}); }
  Program& sjmp(unsigned target) { return put({0x80, (target - at_ - 2) & 0xFFU}); }
  Program& halt() { return sjmp(at_); }
  /// JB and JNB.
  Program& jb(std::uint8_t bit, unsigned target) { return put({0x20, bit, (target - at_ - 3) & 0xFFU}); }
  Program& jnb(std::uint8_t bit, unsigned target) { return put({0x30, bit, (target - at_ - 3) & 0xFFU}); }
  Program& djnzR(unsigned index, unsigned target) { return put({0xD8 + index, (target - at_ - 2) & 0xFFU}); }
  Program& reti() { return put({0x32}); }
  [[nodiscard]] const std::vector<std::uint8_t>& code() const { return code_; }

 private:
  std::vector<std::uint8_t> code_;
  unsigned at_{};
};

/// A program on a controller, looked at from inside.
class Bench {
 public:
  Bench(std::string_view part, const Program& program)
      : part_(partCalled(part)), chip_(part_, sized(program.code(), part_.code_bytes), 1U << 20U) {
    chip_.settle();
  }
  /// Runs to the end of the instruction that reaches this tick. Events of the reset, at tick 1, are left out.
  std::vector<emulator::PinEvent> runTo(Tick tick) {
    while (chip_.now() < tick && chip_.fault().empty() && chip_.end().empty()) {
      chip_.execute(tick);
      while (chip_.settle()) {
      }
    }
    auto events = chip_.ports().take(kNever);
    std::erase_if(events, [](const emulator::PinEvent& event) { return event.tick <= 1; });
    return events;
  }
  Chip& chip() { return chip_; }
  std::uint8_t ram(std::uint8_t address) { return chip_.cpu().iram()[address]; }

 private:
  static std::vector<std::uint8_t> sized(std::vector<std::uint8_t> code, std::size_t size) {
    code.resize(size, 0xFF);
    return code;
  }
  const Part& part_;
  Chip chip_;
};

/// Ticks at which a pin changes.
inline std::vector<Tick> changesOf(const std::vector<emulator::PinEvent>& events, unsigned port,
                                   unsigned bit) {
  std::vector<Tick> ticks;
  for (const auto& event : events) {
    if (event.port == port && (event.changed >> bit & 1) != 0) ticks.push_back(event.tick);
  }
  return ticks;
}

/// Differences of neighbours, in units.
inline std::vector<Tick> stepsOf(const std::vector<Tick>& ticks, Tick unit = 12) {
  std::vector<Tick> steps;
  for (std::size_t i = 1; i < ticks.size(); ++i) steps.push_back((ticks[i] - ticks[i - 1]) / unit);
  return steps;
}

}  // namespace kerfbench::mcs51_child
