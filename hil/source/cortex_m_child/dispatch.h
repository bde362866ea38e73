// SPDX-License-Identifier: Apache-2.0
// How an operation goes on with the next. All here has the form of a Handler, so that each call of it can be
// a jump, and the way from one instruction to the next is a few instructions of the host.
#pragma once

#include "hil/source/cortex_m_child/processor.h"

namespace kerfbench::cortex_m_child {

/// Stops before an operation, of which the line is fetched, because the limit is reached; or goes on where
/// that is no place to stop.
Stop stopBefore(Processor& p, Operation* next, Cycle now);
/// Decodes an operation and begins it.
Stop decodeFirst(Processor& p, Operation* at, Cycle now);
/// The PC is loaded with Processor::pc; `at` did it, and its cycles count.
Stop jumpToPc(Processor& p, Operation* at, Cycle now);

/// Begins an operation whose line is fetched.
[[gnu::always_inline]] inline Stop begin(Processor& p, Operation* next, Cycle now) {
  if (now >= p.limit) [[unlikely]]
    KERFBENCH_TAIL return stopBefore(p, next, now);
  KERFBENCH_TAIL return next->execute(p, next, now + next->cycles);
}

/// The line after that of the operation before, in sequence.
[[gnu::always_inline]] inline Cycle afterNextLine(Processor& p, Cycle now) {
  now = p.prefetches ? std::max(now, p.next_line_at) : now + p.wait_states;
  p.next_line_at = now + 1 + p.wait_states;
  return now;
}

[[gnu::always_inline]] inline Stop next(Processor& p, Operation* at, Cycle now) {
  Operation* const following = at + at->step;
  if (following->has(Operation::kCrosses)) now = afterNextLine(p, now);
  KERFBENCH_TAIL return begin(p, following, now);
}

/// Goes on behind a load, with which some instructions overlap.
[[gnu::always_inline]] inline Stop nextAfterLoad(Processor& p, Operation* at, Cycle now) {
  Operation* const following = at + at->step;
  if (following->has(Operation::kCrosses)) now = afterNextLine(p, now);
  if (now >= p.limit || following->has(Operation::kConditional | Operation::kUndecoded)) [[unlikely]] {
    p.last_load = at->loads;
    KERFBENCH_TAIL return begin(p, following, now);
  }
  const bool overlaps = following->has(Operation::kPipelines) && following->base != at->loads;
  KERFBENCH_TAIL return following->execute(p, following, now + following->cycles - (overlaps ? 1U : 0U));
}

/// The way to the target of a branch: the pipeline is refilled, and its line fetched.
[[gnu::always_inline]] inline Cycle afterBranch(Processor& p, const Operation* at, const Operation* target,
                                                Cycle now) {
  now += target->refill;
  const std::uint32_t from = at->line();
  const std::uint32_t to = target->line();
  if (to != from && target->pc < kSramBase) now = p.afterFetch(now, to == from + 1);
  return now;
}

/// A branch backwards that stays where it is until an interrupt comes is passed over.
[[gnu::always_inline]] inline bool closesIdleLoop(Processor& p, const Operation* target, Cycle now) {
  if (p.loop.head != target->pc || p.has_effect) {
    p.has_effect = false;
    p.loop.head = target->pc;
    p.loop.pure_iterations = 0;
    p.loop.next_look = 8;
    p.loop.began = now;
    return false;
  }
  if (++p.loop.pure_iterations >= p.loop.next_look) [[unlikely]]
    return p.looksIdle(now);
  p.loop.began = now;
  return false;
}

void decode(Processor& p, Operation& operation);
/// ITSTATE behind an instruction that has this.
std::uint8_t ifThenAfter(std::uint8_t if_then);
/// The operations from Processor::pc on, which Processor::if_then makes conditional.
Operation* resumeIfThen(Processor& p);

/// A direct branch that is taken.
[[gnu::always_inline]] inline Stop branch(Processor& p, Operation* at, Cycle now) {
  Operation* const target = at->target;
  if (target->has(Operation::kUndecoded)) [[unlikely]]
    decode(p, *target);
  bool is_idle = false;
  if (target->pc <= at->pc) is_idle = closesIdleLoop(p, target, now);
  now = afterBranch(p, at, target, now);
  if (is_idle) [[unlikely]]
    now = p.afterIdleLoop(now);
  KERFBENCH_TAIL return begin(p, target, now);
}

/// Whether a condition of ARMv7-M holds. Constant conditions cost what they ask.
[[gnu::always_inline]] inline bool holds(const Processor& p, unsigned condition) {
  bool is_so = true;
  const auto is_negative = (p.negative >> 31U) != 0;
  const auto has_overflown = (p.overflow >> 31U) != 0;
  switch (condition >> 1U) {
    case 0:
      is_so = p.zero == 0;
      break;
    case 1:
      is_so = p.carry != 0;
      break;
    case 2:
      is_so = is_negative;
      break;
    case 3:
      is_so = has_overflown;
      break;
    case 4:
      is_so = p.carry != 0 && p.zero != 0;
      break;
    case 5:
      is_so = is_negative == has_overflown;
      break;
    case 6:
      is_so = p.zero != 0 && is_negative == has_overflown;
      break;
    default:
      return true;
  }
  return is_so != ((condition & 1U) != 0);
}

}  // namespace kerfbench::cortex_m_child
