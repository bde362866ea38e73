// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/core.h"

#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::array kScratch{0U, 1U, 2U, 3U, 12U, 14U};
constexpr unsigned kNegative = 31, kZero = 30, kCarry = 29, kOverflow = 28, kSaturated = 27;

}  // namespace

Stop Core::run() {
  Operation* at = p_.if_then != 0 ? resumeIfThen(p_) : p_.operationAt(p_.pc);
  if (at == nullptr) {
    p_.fault_address = p_.pc;
    return Stop::kBadFetch;
  }
  if (at->has(Operation::kUndecoded)) decode(p_, *at);
  Cycle now = p_.present.cycle;
  const std::uint32_t line = at->line();
  if (line != p_.line && at->pc < kSramBase) now = p_.afterFetch(now, line == p_.line + 1);
  p_.line = line;
  if (now >= p_.limit && !at->has(Operation::kConditional)) {
    p_.present.cycle = now;
    return Stop::kLimit;
  }
  const bool overlaps =
      at->has(Operation::kPipelines) && p_.last_load != Timing::kNoRegister && p_.last_load != at->base;
  p_.last_load = Timing::kNoRegister;
  return at->execute(p_, at, now + at->cycles - (overlaps ? 1U : 0U));
}

void Core::setFlashTiming(unsigned wait_states, bool prefetches) {
  p_.wait_states = wait_states;
  p_.prefetches = prefetches;
}

void Core::setTraps(bool of_unaligned, bool of_division) {
  p_.traps_unaligned = of_unaligned;
  p_.traps_division = of_division;
}

void Core::jump(std::uint32_t address) {
  p_.pc = address & ~1U;
  p_.has_effect = true;
  p_.exclusive = false;
  p_.last_load = Timing::kNoRegister;
  p_.if_then = 0;
  p_.line = p_.pc / 8;
  p_.next_line_at = p_.present.cycle + 1 + p_.wait_states;
}

void Core::continueBehind(std::uint32_t bytes) {
  p_.pc += bytes;
  p_.has_effect = true;
  p_.last_load = Timing::kNoRegister;
  p_.if_then = ifThenAfter(p_.if_then);
}

void Core::set(unsigned register_number, std::uint32_t value) {
  p_.r[register_number] = register_number == kSp ? value & ~3U : value;
}

std::uint32_t Core::flags() const {
  return (p_.negative >> 31U) << kNegative | (p_.zero == 0 ? 1U << kZero : 0U) | p_.carry << kCarry |
         (p_.overflow >> 31U) << kOverflow | (p_.saturated ? 1U << kSaturated : 0U);
}

void Core::setFlags(std::uint32_t value) {
  p_.negative = value;
  p_.zero = (value >> kZero & 1U) ^ 1U;
  p_.carry = value >> kCarry & 1U;
  p_.overflow = value << (31 - kOverflow);
  p_.saturated = (value >> kSaturated & 1U) != 0;
}

std::uint32_t Core::ifThen() const {
  const std::uint32_t if_then = p_.if_then;
  return (if_then & 3U) << 25U | if_then >> 2U << 10U;
}

void Core::setIfThen(std::uint32_t value) {
  p_.if_then = static_cast<std::uint8_t>((value >> 25U & 3U) | (value >> 10U & 0x3FU) << 2U);
  if ((p_.if_then & 0xFU) == 0) p_.if_then = 0;
}

std::array<std::uint32_t, 6> Core::scratch() const {
  std::array<std::uint32_t, 6> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = get(kScratch[i]);
  return values;
}

void Core::setScratch(const std::array<std::uint32_t, 6>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) set(kScratch[i], values[i]);
}

}  // namespace kerfbench::cortex_m_child
