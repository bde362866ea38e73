// SPDX-License-Identifier: Apache-2.0
// One instruction after the other: which function carries out which opcode, and the loop over them.
#include <utility>

#include "hil/source/mcs51_child/cpu.h"
#include "hil/source/mcs51_child/instructions.h"
#include "hil/source/mcs51_child/jumps.h"

namespace kerfbench::mcs51_child {

template <unsigned kOpcode>
[[gnu::always_inline]] inline void Cpu::execute(Pc& pc) {
  constexpr unsigned kRow = kOpcode >> 4U;
  constexpr unsigned kColumn = kOpcode & 0xFU;
  if constexpr (kColumn == 1) {
    executeJump<kOpcode>(pc);
  } else if constexpr (kColumn < 4) {
    executeOther<kOpcode>(pc);
  } else if constexpr (kRow < 0x2) {
    step<kOpcode>(pc);
  } else if constexpr (kOpcode == 0x84 || kOpcode == 0xA4) {
    executeAccumulator<kOpcode>();
  } else if constexpr (kRow == 0xB) {
    executeCompare<kOpcode>(pc);
  } else if constexpr (kRow == 0xC || kRow == 0xD) {
    executeExchange<kOpcode>(pc);
  } else if constexpr (kOpcode == 0xE4) {
    acc() = 0;
  } else if constexpr (kRow == 0xE) {
    acc() = source<kOpcode>(pc);
  } else if constexpr (kRow == 0x7 || kRow == 0x8 || kRow == 0xA || kRow == 0xF) {
    executeMove<kOpcode>(pc);
  } else {
    executeArithmetic<kOpcode>(pc);
  }
}

template <unsigned kOpcode>
Cpu::Pc Cpu::carryOut(Cpu& cpu, Pc pc) {
  cpu.execute<kOpcode>(pc);
  return pc;
}

Tick Cpu::run(Tick now, Tick horizon) {
  static constexpr std::array<Instruction, 256> kInstructions = table(std::make_index_sequence<256>{});
  const std::uint8_t* const code = code_.data();
  const std::uint8_t* const clocks = clocks_.data();
  const Pc code_end = part_.code_bytes;
  Pc pc = pc_;
  horizon_ = horizon;
  do {
    began_at_ = pc;
    const std::uint8_t opcode = code[pc];
    now += clocks[opcode];
    ends_ = now;
    if (pc >= code_end) [[unlikely]]
      setFault("the program counter left the code memory");
    pc = kInstructions[opcode](*this, pc + 1);
  } while (now < horizon_);
  pc_ = pc;
  ends_ = now + std::exchange(passed_, 0);
  return ends_;
}

}  // namespace kerfbench::mcs51_child
