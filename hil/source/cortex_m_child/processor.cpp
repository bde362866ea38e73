// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/processor.h"

#include <cstring>

#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

/// Bytes before a changed half-word whose operations may depend on it: an IT has up to four wide
/// instructions.
constexpr std::uint32_t kReachBack = 18;

template <typename Value>
std::uint32_t valueOf(const std::uint8_t* at) {
  Value value{};
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// A value of 1, 2 or 4 bytes.
std::uint32_t valueAt(const std::uint8_t* at, unsigned bytes) {
  if (bytes == 4) return valueOf<std::uint32_t>(at);
  return bytes == 2 ? valueOf<std::uint16_t>(at) : *at;
}

template <typename Memory>
std::optional<std::uint32_t> readFrom(const Memory& memory, std::uint32_t offset, unsigned bytes) {
  if (offset >= memory.size() || memory.size() - offset < bytes) return std::nullopt;
  return valueAt(memory.data() + offset, bytes);
}

}  // namespace

CodeRegion::CodeRegion(std::uint32_t first_address, std::span<std::uint8_t> memory, Handler undecoded)
    : base(first_address), bytes(memory), operations(memory.size() / 2 + 2) {
  for (std::size_t i = 0; i < operations.size(); ++i) {
    operations[i].execute = undecoded;
    operations[i].pc = base + static_cast<std::uint32_t>(2 * i);
  }
}

Processor::Processor(Present& the_present, CoreBus& the_bus, std::span<std::uint8_t> flash,
                     std::span<std::uint8_t> the_sram, std::span<std::uint8_t> the_system_memory)
    : sram(the_sram.data()),
      sram_bytes(static_cast<std::uint32_t>(the_sram.size())),
      flash_region(kFlashBase, flash, &decodeFirst),
      sram_region(kSramBase, the_sram, &decodeFirst),
      alias_region(0, flash, &decodeFirst),
      system_memory(the_system_memory),
      present(the_present),
      bus(the_bus),
      blocks(kBlock * kBlocks) {}

CodeRegion* Processor::regionAt(std::uint32_t address) {
  for (CodeRegion* region : {&flash_region, &sram_region, &alias_region}) {
    if (address - region->base < region->bytes.size()) return region;
  }
  return nullptr;
}

Operation* Processor::operationAt(std::uint32_t address) {
  CodeRegion* const region = regionAt(address);
  return region == nullptr ? nullptr : region->at(address);
}

std::optional<std::uint16_t> Processor::halfWord(std::uint32_t address) const {
  for (const CodeRegion* region : {&flash_region, &sram_region, &alias_region}) {
    if (const auto value = readFrom(region->bytes, address - region->base, 2))
      return static_cast<std::uint16_t>(*value);
  }
  return std::nullopt;
}

void Processor::forgetIn(CodeRegion& region, std::uint32_t offset, std::uint32_t count) {
  const std::uint32_t first = offset < kReachBack ? 0 : offset - kReachBack;
  const auto size = static_cast<std::uint32_t>(region.bytes.size());
  const std::uint32_t end = std::min(size, offset + count);
  for (std::uint32_t at = first; at < end; at += 2) {
    // All else is left as it is: the operation that changes it may be under way.
    region.operations[at / 2].execute = &decodeFirst;
    region.operations[at / 2].flags = Operation::kUndecoded;
  }
}

void Processor::forgetCode(std::uint32_t address, std::uint32_t count) {
  if (address - kSramBase < sram_bytes) {
    const std::uint32_t offset = address - kSramBase;
    if (offset + count > sram_code && offset < sram_code + sram_code_bytes)
      forgetIn(sram_region, offset, count);
    return;
  }
  const std::uint32_t offset = address - kFlashBase;
  if (offset >= flash_region.bytes.size()) return;
  forgetIn(flash_region, offset, count);
  forgetIn(alias_region, offset, count);
}

void Processor::forgetAll() {
  for (CodeRegion* region : {&flash_region, &sram_region, &alias_region})
    forgetIn(*region, 0, static_cast<std::uint32_t>(region->bytes.size()));
  next_block = 1;
}

bool Processor::isDevice(std::uint32_t address) const {
  return address - kDeviceBase < kDeviceBytes || address - kSystemBase < kSystemBytes ||
         address - kDeviceAliasBase < kDeviceBytes * 32 || address - kSramAliasBase < sram_bytes * 32;
}

std::optional<std::uint32_t> Processor::fail(std::uint32_t address, Stop why) {
  fault_address = address;
  failure = why;
  return std::nullopt;
}

std::optional<std::uint32_t> Processor::readElsewhere(const Operation* at, std::uint32_t address,
                                                      unsigned bytes) {
  const bool is_unaligned = (address & (bytes - 1)) != 0;
  if (is_unaligned && traps_unaligned) return fail(address, Stop::kUnaligned);
  if (const auto value = readFrom(flash_region.bytes, address - kFlashBase, bytes)) return value;
  if (const auto value = readFrom(sram_region.bytes, address - kSramBase, bytes)) return value;
  if (isDevice(address)) {
    if (is_unaligned) return fail(address, Stop::kUnaligned);
    has_effect = true;
    pc = at->pc;
    const auto value = bus.readDevice(address, bytes);
    return value ? value : fail(address, Stop::kBadAccess);
  }
  if (const auto value = readFrom(alias_region.bytes, address, bytes)) return value;
  if (const auto value = readFrom(system_memory, address - kSystemMemoryBase, bytes)) return value;
  return fail(address, Stop::kBadAccess);
}

bool Processor::writeElsewhere(const Operation* at, std::uint32_t address, unsigned bytes,
                               std::uint32_t value) {
  const bool is_unaligned = (address & (bytes - 1)) != 0;
  if (is_unaligned && (traps_unaligned || isDevice(address)))
    return fail(address, Stop::kUnaligned).has_value();
  has_effect = true;
  pc = at->pc;
  if (address - kSramBase < sram_bytes && sram_bytes - (address - kSramBase) >= bytes) {
    std::memcpy(sram + (address - kSramBase), &value, bytes);
    forgetCode(address, bytes);
    return true;
  }
  const auto flash_bytes = static_cast<std::uint32_t>(flash_region.bytes.size());
  const std::uint32_t offset = address < flash_bytes ? address : address - kFlashBase;
  if (offset < flash_bytes && flash_bytes - offset >= bytes) {
    if (!bus.writeFlash(offset, bytes, value)) return fail(address, Stop::kBadAccess).has_value();
    forgetCode(kFlashBase + offset, bytes);
    return true;
  }
  if (isDevice(address) && bus.writeDevice(address, bytes, value)) return true;
  return fail(address, Stop::kBadAccess).has_value();
}

std::optional<std::uint32_t> Processor::readWord(const Operation* at, std::uint32_t address) {
  if ((address & 3U) != 0) return fail(address, Stop::kUnaligned);
  return readElsewhere(at, address, 4);
}

bool Processor::writeWord(const Operation* at, std::uint32_t address, std::uint32_t value) {
  if ((address & 3U) != 0) return fail(address, Stop::kUnaligned).has_value();
  return writeElsewhere(at, address, 4, value);
}

Cycle Processor::afterFetch(Cycle now, bool is_next_line) {
  now = is_next_line && prefetches ? std::max(now, next_line_at) : now + wait_states;
  next_line_at = now + 1 + wait_states;
  return now;
}

/// Whether registers and time of the loop are those of the iteration before.
bool Processor::looksIdle(Cycle now) {
  constexpr unsigned kNextLooks = 64;
  const Cycle period = now - loop.began;
  loop.began = now;
  std::array<std::uint32_t, 16> state{};
  std::copy_n(r.begin(), 15, state.begin());
  state[15] = (negative & 0x80000000U) | (zero == 0 ? 1U : 0U) | carry << 1U | (overflow >> 31U) << 2U;
  const bool is_second = loop.pure_iterations > loop.next_look;
  const bool is_idle = is_second && state == loop.state && period == loop.period;
  if (is_second) loop.next_look = loop.pure_iterations + kNextLooks;
  loop.state = state;
  loop.period = period;
  return is_idle;
}

/// The time after as many iterations as end before the limit.
Cycle Processor::afterIdleLoop(Cycle now) {
  loop.next_look = loop.pure_iterations + 1;
  if (loop.period == 0 || limit <= now) return now;
  const Cycle skipped = (limit - now) / loop.period * loop.period;
  next_line_at += skipped;
  loop.began += skipped;
  return now + skipped;
}

Stop Processor::stopAt(const Operation* at, Cycle now, Stop why) {
  present.cycle = now;
  pc = at->pc;
  line = at->line();
  last_load = Timing::kNoRegister;
  if (at->has(Operation::kConditional)) if_then = static_cast<std::uint8_t>((at - 1)->number);
  return why;
}

Stop stopBefore(Processor& p, Operation* next, Cycle now) {
  if (next->has(Operation::kConditional)) KERFBENCH_TAIL return next->execute(p, next, now + next->cycles);
  if (next->has(Operation::kUndecoded)) {
    decode(p, *next);
    if (next->has(Operation::kCrosses)) now = afterNextLine(p, now);
  }
  p.present.cycle = now;
  p.pc = next->pc;
  p.line = next->line();
  return Stop::kLimit;
}

Stop decodeFirst(Processor& p, Operation* at, Cycle now) {
  decode(p, *at);
  if (at->has(Operation::kCrosses)) now = afterNextLine(p, now);
  if (now >= p.limit) KERFBENCH_TAIL return stopBefore(p, at, now);
  const bool overlaps =
      at->has(Operation::kPipelines) && p.last_load != Timing::kNoRegister && p.last_load != at->base;
  p.last_load = Timing::kNoRegister;
  KERFBENCH_TAIL return at->execute(p, at, now + at->cycles - (overlaps ? 1U : 0U));
}

Stop jumpToPc(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t address = p.pc;
  if (address >= kExceptionReturns) {
    p.fault_address = address;
    return p.stopAt(at, now, Stop::kExceptionExit);
  }
  if ((address & 1U) == 0) return p.stopAt(at, now, Stop::kNotThumb);
  Operation* const target = p.operationAt(address & ~1U);
  if (target == nullptr) {
    p.fault_address = address & ~1U;
    return p.stopAt(at, now, Stop::kBadFetch);
  }
  if (target->has(Operation::kUndecoded)) decode(p, *target);
  now = afterBranch(p, at, target, now + 1);
  KERFBENCH_TAIL return begin(p, target, now);
}

}  // namespace kerfbench::cortex_m_child
