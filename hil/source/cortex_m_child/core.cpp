// SPDX-License-Identifier: GPL-2.0-or-later
#include "hil/source/cortex_m_child/core.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kLineBytes = 8;
constexpr std::uint32_t kNoLine = 0xFFFFFFFF;
constexpr std::uint64_t kNowhere = 0xFFFFFFFE;  // Where Unicorn would end by itself.
constexpr std::uint32_t kExceptionReturns = 0xFFFFFFF0;
constexpr std::array kRegisters{UC_ARM_REG_R0,  UC_ARM_REG_R1,  UC_ARM_REG_R2,  UC_ARM_REG_R3,
                                UC_ARM_REG_R4,  UC_ARM_REG_R5,  UC_ARM_REG_R6,  UC_ARM_REG_R7,
                                UC_ARM_REG_R8,  UC_ARM_REG_R9,  UC_ARM_REG_R10, UC_ARM_REG_R11,
                                UC_ARM_REG_R12, UC_ARM_REG_R13, UC_ARM_REG_R14, UC_ARM_REG_R15};
constexpr std::array kScratch{0U, 1U, 2U, 3U, 12U, 14U};
// Numbers of exceptions in QEMU's target/arm/cpu.h, which UC_HOOK_INTR passes on.
constexpr std::uint32_t kQemuPrefetchAbort = 3, kQemuExceptionExit = 8;

void check(uc_err error, const char* what) {
  if (error != UC_ERR_OK)
    throw std::runtime_error(std::string("Unicorn: ") + what + ": " + uc_strerror(error));
}

template <typename Function>
void* hookOf(Function* function) {
  return reinterpret_cast<void*>(function);
}

}  // namespace

Core::Core(Present& present, CoreBus& bus, std::span<std::uint8_t> flash, std::span<std::uint8_t> sram,
           std::span<std::uint8_t> system_memory)
    : present_(present), bus_(bus), flash_(flash), sram_(sram), timings_(flash.size() / 2) {
  const int mode = UC_MODE_THUMB | UC_MODE_MCLASS;
  check(uc_open(UC_ARCH_ARM, static_cast<uc_mode>(mode), &engine_), "uc_open");
  check(uc_ctl_set_cpu_model(engine_, UC_CPU_ARM_CORTEX_M3), "the model of the core");
  constexpr std::uint32_t kReadable = UC_PROT_READ | UC_PROT_EXEC;
  mapMemory(0, flash, kReadable);
  mapMemory(kFlashBase, flash, kReadable);
  mapMemory(kSystemMemoryBase, system_memory, kReadable);
  mapMemory(kSramBase, sram, UC_PROT_ALL);
  mapDevices<kSramAliasBase>(static_cast<std::uint32_t>(sram.size()) * 32);
  mapDevices<kDeviceBase>(kDeviceBytes);
  mapDevices<kDeviceAliasBase>(kDeviceBytes * 32);
  mapDevices<kSystemBase>(kSystemBytes);
  uc_hook hook = 0;
  check(uc_hook_add(engine_, &hook, UC_HOOK_CODE, hookOf(&onCode), this, 1, 0), "a hook");
  check(uc_hook_add(engine_, &hook, UC_HOOK_INTR, hookOf(&onException), this, 1, 0), "a hook");
  check(uc_hook_add(engine_, &hook, UC_HOOK_MEM_INVALID, hookOf(&onBadMemory), this, 1, 0), "a hook");
}

Core::~Core() { uc_close(engine_); }

void Core::mapMemory(std::uint32_t base, std::span<std::uint8_t> bytes, std::uint32_t permissions) {
  check(uc_mem_map_ptr(engine_, base, bytes.size(), permissions, bytes.data()), "memory");
}

template <std::uint32_t kBase>
void Core::mapDevices(std::uint32_t bytes) {
  check(uc_mmio_map(engine_, kBase, bytes, &onRead<kBase>, this, &onWrite<kBase>, this), "devices");
}

void Core::onCode(uc_engine* /*engine*/, std::uint64_t address, std::uint32_t size, void* self) {
  static_cast<Core*>(self)->beforeInstruction(static_cast<std::uint32_t>(address), size);
}

void Core::onException(uc_engine* engine, std::uint32_t number, void* self) {
  auto& core = *static_cast<Core*>(self);
  std::uint32_t at = 0;
  uc_reg_read(engine, UC_ARM_REG_PC, &at);
  core.fault_address_ = at;
  if (number == kQemuExceptionExit || at >= kExceptionReturns) {
    core.exception_return_ = at | 1U;
    core.stop_ = Stop::kExceptionExit;
  } else {
    core.stop_ = number == kQemuPrefetchAbort ? Stop::kBadFetch : Stop::kUndefined;
  }
  uc_emu_stop(engine);
}

bool Core::onBadMemory(uc_engine* /*engine*/, uc_mem_type type, std::uint64_t address, int size,
                       std::int64_t value, void* self) {
  auto& core = *static_cast<Core*>(self);
  const auto at = static_cast<std::uint32_t>(address);
  const std::uint32_t offset = at < core.flash_.size() ? at : at - kFlashBase;
  const auto bytes = static_cast<unsigned>(size);
  if (type == UC_MEM_WRITE_PROT && offset < core.flash_.size() && bytes <= 4 &&
      offset + bytes <= core.flash_.size()) {
    // Unicorn stores what it is given; what the flash makes of it is put there afterwards.
    core.bus_.writeFlash(offset, bytes, static_cast<std::uint32_t>(value));
    Repair repair{offset, {}, bytes};
    std::copy_n(core.flash_.begin() + offset, bytes, repair.bytes.begin());
    core.repairs_.push_back(repair);
    core.limit_ = 0;
    return true;
  }
  core.fault_address_ = at;
  const bool is_fetch = type == UC_MEM_FETCH_UNMAPPED || type == UC_MEM_FETCH_PROT || type == UC_MEM_FETCH;
  if (is_fetch && at >= kExceptionReturns) {
    core.exception_return_ = at | 1U;
    core.stop_ = Stop::kExceptionExit;
  } else {
    core.stop_ = is_fetch ? Stop::kBadFetch : Stop::kBadAccess;
  }
  return false;
}

template <std::uint32_t kBase>
std::uint64_t Core::onRead(uc_engine* /*engine*/, std::uint64_t offset, unsigned size, void* self) {
  static_cast<Core*>(self)->has_effect_ = true;
  return static_cast<Core*>(self)->bus_.readDevice(kBase + static_cast<std::uint32_t>(offset), size);
}

template <std::uint32_t kBase>
void Core::onWrite(uc_engine* /*engine*/, std::uint64_t offset, unsigned size, std::uint64_t value,
                   void* self) {
  static_cast<Core*>(self)->has_effect_ = true;
  static_cast<Core*>(self)->bus_.writeDevice(kBase + static_cast<std::uint32_t>(offset), size,
                                             static_cast<std::uint32_t>(value));
}

void Core::beforeInstruction(std::uint32_t pc, std::uint32_t size) {
  const std::uint32_t index = (pc - kFlashBase) >> 1;
  Timing timing = index < timings_.size() ? timings_[index] : Timing{};
  if (!timing.has(Timing::kKnown)) timing = timingAt(pc);
  Cycle now = present_.cycle;
  if (pc != expected_) {
    if (pc < expected_) watchLoop(pc, now);
    now += jumpCycles(pc, size);
  }
  const std::uint32_t line = (pc + size - 2) / kLineBytes;
  if (line != line_) now = afterFetch(now, line);
  if (is_idle_) now = afterIdleLoop(now);
  has_effect_ |= timing.has(Timing::kStores);
  if (now >= limit_ || (timing.flags & (Timing::kTrap | Timing::kIfThen)) != 0) {
    if (stopsAt(pc, timing, now)) return;
  }
  now += timing.cycles;
  if (timing.has(Timing::kPipelines) && last_load_ != Timing::kNoRegister && last_load_ != timing.base) --now;
  if (timing.has(Timing::kLiteral)) now += wait_states_;
  last_load_ = timing.loads;
  last_flags_ = timing.flags;
  pc_ = pc;
  expected_ = pc + size;
  present_.cycle = now;
}

/// Whether the core stops before this instruction; its place is kept then, with all that led there paid for.
bool Core::stopsAt(std::uint32_t pc, const Timing& timing, Cycle now) {
  const bool is_conditional = pc > if_then_ && pc < if_then_end_;
  const bool is_due = now >= limit_ && !is_conditional;
  if (!is_due && !timing.has(Timing::kTrap)) {
    if (timing.has(Timing::kIfThen)) beginIfThen(pc);
    return false;
  }
  stop_ = is_due ? Stop::kLimit : Stop::kTrap;
  present_.cycle = now;
  pc_ = expected_ = pc;
  uc_emu_stop(engine_);
  return true;
}

std::optional<std::uint16_t> Core::halfWord(std::uint32_t address) const {
  const auto from = [address](std::span<const std::uint8_t> memory,
                              std::uint32_t base) -> std::optional<std::uint16_t> {
    if (address - base >= memory.size() || address - base + 2 > memory.size()) return std::nullopt;
    std::uint16_t value = 0;
    std::memcpy(&value, memory.data() + (address - base), sizeof value);
    return value;
  };
  if (const auto value = from(flash_, kFlashBase)) return value;
  if (const auto value = from(sram_, kSramBase)) return value;
  return from(flash_, 0);
}

Timing Core::timingAt(std::uint32_t pc) {
  const Timing timing = timingOf(halfWord(pc).value_or(0), halfWord(pc + 2).value_or(0));
  const std::uint32_t index = (pc - kFlashBase) >> 1;
  if (index < timings_.size()) timings_[index] = timing;
  return timing;
}

/// The way from the last instruction to one that does not follow it: a branch, or IT has skipped some.
Cycle Core::jumpCycles(std::uint32_t pc, std::uint32_t size) {
  if (expected_ > if_then_ && expected_ < if_then_end_ && pc > expected_ && pc <= if_then_end_) {
    Cycle skipped = 0;
    for (std::uint32_t at = expected_; at < pc; at += isWide(halfWord(at).value_or(0)) ? 4 : 2) ++skipped;
    return skipped;
  }
  const bool is_indirect = (last_flags_ & Timing::kIndirect) != 0;
  const bool is_unaligned = size == 4 && (pc & 2U) != 0;
  last_load_ = Timing::kNoRegister;
  return 1U + (is_indirect ? 1U : 0U) + (is_unaligned ? 1U : 0U);
}

Cycle Core::afterFetch(Cycle now, std::uint32_t line) {
  const bool is_flash = line * kLineBytes < kSramBase;
  if (is_flash) {
    const bool is_prefetched = prefetches_ && line == next_line_;
    now = is_prefetched ? std::max(now, next_line_at_) : now + wait_states_;
    next_line_ = line + 1;
    next_line_at_ = now + 1 + wait_states_;
  } else {
    next_line_ = kNoLine;
  }
  line_ = line;
  return now;
}

void Core::beginIfThen(std::uint32_t pc) {
  if_then_ = pc;
  if_then_end_ = pc + 2;
  for (unsigned left = instructionsOfIfThen(halfWord(pc).value_or(8)); left > 0; --left)
    if_then_end_ += isWide(halfWord(if_then_end_).value_or(0)) ? 4 : 2;
}

/// A branch backwards, before its refill: whether nothing has changed since it came here last.
void Core::watchLoop(std::uint32_t head, Cycle now) {
  constexpr unsigned kFirstLook = 8, kNextLooks = 64;
  const bool is_pure = head == loop_.head && !has_effect_;
  has_effect_ = false;
  if (!is_pure) {
    loop_.head = head;
    loop_.pure_iterations = 0;
    loop_.next_look = kFirstLook;
    loop_.began = now;
    return;
  }
  const Cycle period = now - loop_.began;
  loop_.began = now;
  if (++loop_.pure_iterations < loop_.next_look) return;
  std::array<std::uint32_t, 17> state{};
  for (unsigned i = 0; i < 15; ++i) state[i] = get(i);
  state[15] = flags();
  state[16] = head;
  is_idle_ = loop_.pure_iterations > loop_.next_look && state == loop_.state && period == loop_.period;
  if (loop_.pure_iterations > loop_.next_look) loop_.next_look = loop_.pure_iterations + kNextLooks;
  loop_.state = state;
  loop_.period = period;
}

/// The time after as many iterations as end before the limit.
Cycle Core::afterIdleLoop(Cycle now) {
  is_idle_ = false;
  loop_.next_look = loop_.pure_iterations + 1;
  if (loop_.period == 0 || limit_ <= now) return now;
  const Cycle skipped = (limit_ - now) / loop_.period * loop_.period;
  next_line_at_ += skipped;
  loop_.began += skipped;
  return now + skipped;
}

Core::Stop Core::run() {
  stop_.reset();
  const uc_err error = uc_emu_start(engine_, pc_ | 1U, kNowhere, 0, 0);
  repairFlash();
  if (!stop_) {
    std::uint32_t at = 0;
    uc_reg_read(engine_, UC_ARM_REG_PC, &at);
    fault_address_ = at;
    if (error == UC_ERR_INSN_INVALID || error == UC_ERR_EXCEPTION) return Stop::kUndefined;
    return Stop::kBadFetch;
  }
  return *stop_;
}

void Core::repairFlash() {
  for (const Repair& repair : repairs_) {
    std::copy_n(repair.bytes.begin(), repair.size, flash_.begin() + repair.offset);
    forgetCode(kFlashBase + repair.offset, repair.size);
  }
  repairs_.clear();
}

void Core::forgetCode(std::uint32_t address, std::uint32_t bytes) {
  uc_ctl_remove_cache(engine_, std::uint64_t{address}, std::uint64_t{address} + bytes);
  const std::uint32_t offset = address - kFlashBase;
  if (offset >= flash_.size()) return;
  uc_ctl_remove_cache(engine_, std::uint64_t{offset}, std::uint64_t{offset} + bytes);
  const std::size_t first = offset < 2 ? 0 : offset / 2 - 1;
  const std::size_t last = std::min<std::size_t>(timings_.size(), (offset + bytes + 1) / 2);
  for (std::size_t i = first; i < last; ++i) timings_[i] = {};
}

void Core::setFlashTiming(unsigned wait_states, bool prefetches) {
  wait_states_ = wait_states;
  prefetches_ = prefetches;
}

void Core::jump(std::uint32_t address) {
  pc_ = expected_ = address & ~1U;
  has_effect_ = true;
  last_load_ = Timing::kNoRegister;
  if_then_ = if_then_end_ = 0;
  line_ = pc_ / kLineBytes;
  next_line_ = line_ + 1;
  next_line_at_ = present_.cycle + 1 + wait_states_;
}

std::uint32_t Core::get(unsigned register_number) const {
  std::uint32_t value = 0;
  uc_reg_read(engine_, kRegisters[register_number], &value);
  return value;
}

void Core::set(unsigned register_number, std::uint32_t value) {
  uc_reg_write(engine_, kRegisters[register_number], &value);
}

std::uint32_t Core::flags() const {
  std::uint32_t value = 0;
  uc_reg_read(engine_, UC_ARM_REG_XPSR, &value);
  return value;
}

void Core::setFlags(std::uint32_t value) { uc_reg_write(engine_, UC_ARM_REG_XPSR, &value); }

std::array<std::uint32_t, 6> Core::scratch() const {
  std::array<std::uint32_t, 6> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = get(kScratch[i]);
  return values;
}

void Core::setScratch(const std::array<std::uint32_t, 6>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) set(kScratch[i], values[i]);
}

}  // namespace kerfbench::cortex_m_child
