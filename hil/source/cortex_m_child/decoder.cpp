// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/decoder.h"

#include <bit>

#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

Stop undefined(Processor& p, Operation* at, Cycle now) { return p.stopAt(at, now, Stop::kUndefined); }

/// The instruction itself lies where nothing can be executed; the one before it has led there.
Stop fetchNowhere(Processor& p, Operation* at, Cycle now) {
  p.fault_address = at->pc;
  return p.stopAt(at, now, Stop::kBadFetch);
}

Stop ifThen(Processor& p, Operation* at, Cycle now);

bool buildIfThen(const Encoding& e, Operation& op) {
  const bool has_one = std::popcount(e['m']) == 1;
  if (e['c'] == 15 || (e['c'] == 14 && !has_one) || e.in_if_then) return false;
  op.execute = &ifThen;
  op.number = e['c'] << 4U | e['m'];
  return true;
}

constexpr EncodingRow kIfThenRows[] = {{"10111111 cccc mmmm", buildIfThen}};

struct Code {
  std::uint16_t first{};
  std::uint16_t second{};
};

void setTiming(Operation& op, Code code) {
  const Timing timing = timingOf(code.first, code.second);
  op.cycles = timing.has(Timing::kTrap) ? 0 : timing.cycles;
  op.base = timing.base;
  op.loads = timing.loads;
  op.flags = timing.has(Timing::kPipelines) ? Operation::kPipelines : 0;
  const bool is_wide = op.bytes == 4;
  op.refill = is_wide && (op.pc & 2U) != 0 ? 2 : 1;
  if (op.pc < kSramBase && op.line() != (op.pc - 2) / 8) op.flags |= Operation::kCrosses;
}

bool buildFrom(std::span<const EncodingRow> rows, const Encoding& e, unsigned width, Operation& op,
               bool& is_built) {
  for (const EncodingRow& row : rows) {
    if (!row.pattern.matches(e.code, width)) continue;
    const Encoding own{row.pattern, e.code, e.pc, e.in_if_then, e.ends_if_then, e.processor};
    is_built = row.build(own, op);
    return true;
  }
  return false;
}

bool build(Processor& p, Operation& op, Code code, std::uint8_t if_then) {
  static constexpr Pattern kNone = "";
  const bool is_wide = op.bytes == 4;
  const std::uint32_t whole = is_wide ? std::uint32_t{code.first} << 16U | code.second : code.first;
  const Encoding e{kNone, whole, op.pc, if_then != 0, (if_then & 0xFU) == 8, p};
  bool is_built = false;
  for (const auto rows :
       {systemRows(), branchRows(), dataProcessingRows(), singleAccessRows(), multipleAccessRows(),
        arithmeticRows(), std::span<const EncodingRow>(kIfThenRows)}) {
    if (buildFrom(rows, e, is_wide ? 32 : 16, op, is_built)) break;
  }
  return is_built;
}

void noteSramCode(Processor& p, const Operation& op) {
  if (op.pc - kSramBase >= p.sram_bytes) return;
  // Whole words, so that a store that is aligned lies within or beside.
  const std::uint32_t offset = (op.pc - kSramBase) & ~3U;
  const std::uint32_t end =
      std::max(p.sram_code_bytes == 0 ? 0 : p.sram_code + p.sram_code_bytes, offset + 8);
  p.sram_code = p.sram_code_bytes == 0 ? offset : std::min(p.sram_code, offset);
  p.sram_code_bytes = end - p.sram_code;
}

/// Decodes what is at the operation's PC. `if_then` is ITSTATE there.
void decodeAs(Processor& p, Operation& op, std::uint8_t if_then) {
  const auto first = p.halfWord(op.pc);
  const auto second = p.halfWord(op.pc + 2);
  op.bytes = first && isWide(*first) ? 4 : 2;
  op.step = op.bytes / 2;
  op.flags = 0;
  op.cycles = 0;
  noteSramCode(p, op);
  if (!first || (op.bytes == 4 && !second)) {
    op.execute = &fetchNowhere;
    return;
  }
  const Code code{*first, second.value_or(0)};
  if (!build(p, op, code, if_then)) op.execute = &undefined;
  setTiming(op, code);
}

/// Lines of the flash that have begun since the last instruction that was executed.
Cycle afterLines(Processor& p, std::uint32_t lines, Cycle now) {
  p.owed_lines = 0;
  return lines == 1 ? afterNextLine(p, now) : p.afterFetch(now, false);
}

Cycle afterPipelined(Processor& p, const Operation& op, Cycle now) {
  const bool overlaps =
      op.has(Operation::kPipelines) && p.last_load != Timing::kNoRegister && p.last_load != op.base;
  p.last_load = Timing::kNoRegister;
  return overlaps ? now - 1 : now;
}

/// Before each instruction behind an IT: what is skipped takes a cycle, and is not waited for.
Stop gate(Processor& p, Operation* at, Cycle now) {
  if (!holds(p, at->kind)) {
    p.owed_lines += at->shift;
    KERFBENCH_TAIL return at[2].execute(p, at + 2, now + 1);
  }
  if (const std::uint32_t lines = p.owed_lines + at->shift; lines != 0) now = afterLines(p, lines, now);
  now = afterPipelined(p, at[1], now);
  KERFBENCH_TAIL return at[1].execute(p, at + 1, now + at[1].cycles);
}

/// Behind the last instruction that an IT makes conditional.
Stop leaveIfThen(Processor& p, Operation* at, Cycle now) {
  Operation* const following = at->target;
  if (following->has(Operation::kUndecoded)) decode(p, *following);
  const std::uint32_t lines = p.owed_lines + (following->has(Operation::kCrosses) ? 1U : 0U);
  if (lines != 0) now = afterLines(p, lines, now);
  if (now >= p.limit) KERFBENCH_TAIL return stopBefore(p, following, now);
  now = afterPipelined(p, *following, now);
  KERFBENCH_TAIL return following->execute(p, following, now + following->cycles);
}

/// A gate and an operation for each instruction from an address on, and what comes behind them.
void decodeBlock(Processor& p, Operation* block, std::uint32_t pc, std::uint8_t if_then) {
  for (; if_then != 0; if_then = ifThenAfter(if_then), block += 2) {
    Operation& op = block[1];
    op = {};
    op.pc = pc;
    decodeAs(p, op, if_then);
    op.step = 1;
    const std::uint8_t crossings = op.has(Operation::kCrosses) ? 1 : 0;
    op.flags = static_cast<std::uint8_t>((op.flags & ~Operation::kCrosses) | Operation::kConditional);
    block[0] = op;
    block[0].execute = &gate;
    block[0].number = if_then;
    block[0].kind = if_then >> 4U;
    block[0].shift = crossings;
    block[0].cycles = 0;
    block[0].flags = Operation::kConditional;
    pc += op.bytes;
  }
  block[0] = {};
  block[0].execute = &leaveIfThen;
  block[0].pc = pc;
  block[0].flags = Operation::kConditional;
  block[0].target = p.operationAt(pc);
  if (block[0].target != nullptr) return;
  block[0].execute = &fetchNowhere;
  block[0].flags = 0;
}

Stop runBlock(Processor& p, Operation* at, Cycle now) {
  p.owed_lines = 0;
  KERFBENCH_TAIL return at->target->execute(p, at->target, now);
}

/// The first time that an IT is executed.
Stop ifThen(Processor& p, Operation* at, Cycle now) {
  const auto if_then = static_cast<std::uint8_t>(at->number);
  if (p.next_block == Processor::kBlocks) {
    p.forgetAll();
    KERFBENCH_TAIL return decodeFirst(p, at, now - at->cycles);
  }
  Operation* const block = &p.blocks[Processor::kBlock * p.next_block++];
  decodeBlock(p, block, at->pc + 2, if_then);
  at->target = block;
  at->execute = &runBlock;
  KERFBENCH_TAIL return runBlock(p, at, now);
}

}  // namespace

std::uint8_t ifThenAfter(std::uint8_t if_then) {
  if ((if_then & 7U) == 0) return 0;
  return static_cast<std::uint8_t>((if_then & 0xE0U) | (std::uint32_t{if_then} << 1U & 0x1FU));
}

void decode(Processor& p, Operation& op) { decodeAs(p, op, 0); }

Operation* resumeIfThen(Processor& p) {
  decodeBlock(p, p.blocks.data(), p.pc, p.if_then);
  p.blocks.front().shift = 0;  // The line is fetched when the core goes on.
  p.owed_lines = 0;
  p.if_then = 0;
  return p.blocks.data();
}

}  // namespace kerfbench::cortex_m_child
