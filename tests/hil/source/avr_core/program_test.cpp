// SPDX-License-Identifier: GPL-3.0-or-later
// Our core against simavr's own: drawn programs under interrupts of a timer leave the same machine wherever
// ours stops, however their run is cut.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/hil/source/avr_core/tested_avr.h"
#include "twin/base/random.h"

namespace kerfbench::avr_child {
namespace {

constexpr std::uint32_t kBegin = 0x200;

/// A loop of drawn instructions behind the start of Timer 0 with all of its interrupts, for an ATmega328P.
class DrawnLoop {
 public:
  explicit DrawnLoop(std::uint64_t seed) : random_(seed, 7) {
    code_ = {0xE001, 0xBD05, 0xE007, 0x9300, 0x006E};  // TCCR0B = 1, TIMSK0 = 7
    const std::size_t loop = code_.size();
    code_.insert(code_.end(), {0x9478, 0xE007, 0xBF0E, 0xE005, 0xBF0D});  // SEI, SP = 0x0705
    while (code_.size() < loop + 300) draw();
    put(0);  // The last one may skip this.
    code_.push_back(static_cast<std::uint16_t>(0xC000U | ((loop - code_.size() - 1) & 0x0FFFU)));  // RJMP
  }
  [[nodiscard]] const std::vector<std::uint16_t>& code() const { return code_; }

 private:
  std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>(random_.bits(drawn_++) >> 20U) % bound;
  }
  void put(std::uint32_t word) { code_.push_back(static_cast<std::uint16_t>(word)); }

  /// The registers X, Y and Z are set just before they are used.
  void draw() {
    switch (below(8)) {
      case 0:
        return access();
      case 1:
        return io();
      case 2:
        return branch();
      case 3:
        return stack();
      default:
        return calculation();
    }
  }

  /// Two-operand codes, constants, one-operand codes, MUL, ADIW, MOVW, BST, BLD, skips of one of these.
  void calculation() {
    static constexpr std::array<std::uint32_t, 12> kKinds{0x0400, 0x0800, 0x0C00, 0x1400, 0x1800, 0x1C00,
                                                          0x2000, 0x2400, 0x2800, 0x2C00, 0x1000, 0x9C00};
    static constexpr std::array<std::uint32_t, 9> kOnes{0, 1, 2, 3, 5, 6, 7, 10, 3};
    switch (below(6)) {
      case 0:
        return put(((3 + below(5)) % 8U == 3 ? 0x3000U : (4 + below(4)) << 12U) | below(0x1000));
      case 1:
        return put(0x9400U | below(32) << 4U | kOnes[below(9)]);
      case 2:
        return put(0xF800U | below(4) << 9U | below(32) << 4U | below(8));  // BLD, BST, SBRC, SBRS
      case 3:
        return put(0x0100U | below(0x300));  // MOVW, MULS, MULSU, FMUL
      case 4:
        return put(0x9408U | below(16) << 4U);  // BSET and BCLR, SEI and CLI among them
      default:
        return put(kKinds[below(12)] | below(0x400));
    }
  }

  /// BRBS and BRBC over as many words as the calculations behind them have, or fewer.
  void branch() {
    put(0xF000U | below(2) << 10U | below(4) << 3U | below(8));
    for (unsigned i = 0; i < 3; ++i) calculation();
  }

  void access() {
    const std::uint32_t pointer = 26 + 2 * below(3);
    put(0xE000U | (pointer - 16) << 4U | below(16) << 8U | below(16));
    put(0xE000U | (pointer + 1 - 16) << 4U | 2);
    static constexpr std::array<std::array<std::uint32_t, 3>, 3> kForms{
        {{0x900C, 0x900D, 0x900E}, {0x8008, 0x9009, 0x900A}, {0x8000, 0x9001, 0x9002}}};
    put(kForms[(pointer - 26) / 2][below(3)] | below(2) << 9U | below(24) << 4U);
    if (below(4) != 0) return;
    put(0x9000U | below(2) << 9U | below(32) << 4U);  // LDS, STS
    put(0x0300U + below(0x100));
  }

  /// Port B, flags and count of Timer 0, its OCR0A, SREG.
  void io() {
    static constexpr std::array<std::uint32_t, 8> kRegisters{0x03, 0x04, 0x05, 0x15, 0x1E, 0x26, 0x27, 0x3F};
    const std::uint32_t address = kRegisters[below(8)];
    if (address < 0x20 && below(2) == 0) return put(0x9800U | below(4) << 8U | address << 3U | below(8));
    put((below(2) == 0 ? 0xB000U : 0xB800U) | (address & 0x30U) << 5U | below(32) << 4U | (address & 0xFU));
  }

  void stack() {
    if (below(2) == 0) return put((below(2) == 0 ? 0x900FU : 0x920FU) | below(32) << 4U);
    for (const std::uint32_t word : {0xD001U, 0xC001U, 0x9508U}) put(word);  // RCALL; RJMP; RET
  }

  CounterRandom random_;
  std::uint64_t drawn_{};
  std::vector<std::uint16_t> code_;
};

void load(TestedAvr& tested, const DrawnLoop& program) {
  const std::array<std::uint16_t, 2> handler{0x9543, 0x9518};  // INC r20; RETI
  for (std::uint32_t vector = 1; vector < 26; ++vector)
    tested.put(4 * vector, handler.data(), handler.size());
  tested.put(kBegin, program.code().data(), program.code().size());
  tested.avr().pc = kBegin;
  tested.avr().state = cpu_Running;
}

/// Runs both for so many cycles, ours in slices. Counts instructions in handlers of interrupts.
unsigned compareLoop(std::uint64_t seed, Cycle cycles, Cycle slice) {
  const DrawnLoop program(seed);
  TestedAvr ours("atmega328p", TestedAvr::By::kOurs);
  TestedAvr theirs("atmega328p", TestedAvr::By::kSimavr);
  load(ours, program);
  load(theirs, program);
  unsigned in_handlers = 0;
  while (ours.avr().cycle < cycles) {
    ours.advance(ours.avr().cycle + slice);
    while (theirs.avr().cycle < ours.avr().cycle) {
      theirs.advance(0);
      if (theirs.avr().pc < kBegin) ++in_handlers;
    }
    const std::string found = difference(ours, theirs);
    EXPECT_EQ(found, "") << "seed " << seed << ", slices of " << slice;
    if (!found.empty()) break;
  }
  return in_handlers;
}

class DrawnLoops : public testing::TestWithParam<Cycle> {};

TEST_P(DrawnLoops, RunAsSimavrSays) {
  unsigned in_handlers = 0;
  for (std::uint64_t seed = 0; seed < 20 && !HasFailure(); ++seed)
    in_handlers += compareLoop(seed, 20'000, GetParam());
  EXPECT_GT(in_handlers, 2'000U);
}

INSTANTIATE_TEST_SUITE_P(Slices, DrawnLoops, testing::Values(1, 13, 100'000));

TEST(DrawnLoopsLong, OfManySeedsRunAsSimavrSays) {
  for (std::uint64_t seed = 100; seed < 1'100 && !HasFailure(); ++seed) compareLoop(seed, 50'000, 100'000);
}

}  // namespace
}  // namespace kerfbench::avr_child
