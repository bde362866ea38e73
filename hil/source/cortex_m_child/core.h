// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <unicorn/unicorn.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/instruction_timing.h"
#include "hil/source/cortex_m_child/memory_map.h"

namespace kerfbench::cortex_m_child {

/// What the core reaches beside its memories.
class CoreBus {
 public:
  virtual ~CoreBus() = default;
  /// An access to devices, their bits or the system's registers, while Present::cycle is that of the access.
  virtual std::uint32_t readDevice(std::uint32_t address, unsigned bytes) = 0;
  virtual void writeDevice(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;
  /// A store to the flash; it is the interface of the flash that programs it.
  virtual void writeFlash(std::uint32_t offset, unsigned bytes, std::uint32_t value) = 0;
};

/// A Cortex-M3 of Unicorn's without its exceptions, that counts cycles instruction by instruction.
///
/// Unicorn carries out instructions and has no time. A hook before each of them adds what it costs: the
/// table's cycles (instruction_timing.h); after a branch 1 to refill the pipeline where the instruction says
/// the target and 2 where a register does, and 1 more for a wide target that is not aligned (ARM 2010: 1 to
/// 3); and the flash: lines of 64 bits in two buffers, of which the second is fetched while the first is
/// being used (STMicroelectronics 2015 RM0008, Flash access control register). An instruction that IT skips
/// takes a cycle. A store takes effect at the end of its instruction.
///
/// A loop that neither stores nor reaches a device, and leaves all registers as they were, waits for an
/// interrupt: its iterations up to the limit are passed over, and take their time.
class Core {
 public:
  enum class Stop {
    kLimit,          ///< The limit is reached, or was drawn in by an access.
    kTrap,           ///< The instruction at pc() is one of the exception unit's.
    kExceptionExit,  ///< The PC was loaded with exceptionReturn().
    kUndefined,      ///< The instruction at pc() does not exist.
    kBadFetch,       ///< Nothing that could be executed is at faultAddress().
    kBadAccess       ///< The instruction at pc() has no memory at faultAddress().
  };

  Core(Present& present, CoreBus& bus, std::span<std::uint8_t> flash, std::span<std::uint8_t> sram,
       std::span<std::uint8_t> system_memory);
  ~Core();
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  /// Runs until an instruction would begin at the limit or later, except between an IT and the instructions
  /// that depend on it.
  Stop run();
  void setLimit(Cycle limit) { limit_ = limit; }
  void setFlashTiming(unsigned wait_states, bool prefetches);
  /// Memory has changed behind the core's back: forget translations.
  void forgetCode(std::uint32_t address, std::uint32_t bytes);

  [[nodiscard]] std::uint32_t pc() const { return pc_; }
  /// Goes on there; the pipeline is refilled at no cost, because an exception's cycles contain it.
  void jump(std::uint32_t address);
  /// Goes on there as after any instruction.
  void continueAt(std::uint32_t address) {
    pc_ = expected_ = address;
    has_effect_ = true;
    last_load_ = Timing::kNoRegister;
  }
  [[nodiscard]] std::uint32_t faultAddress() const { return fault_address_; }
  [[nodiscard]] std::uint32_t exceptionReturn() const { return exception_return_; }
  /// Half-word at an address of flash or SRAM; nothing elsewhere.
  [[nodiscard]] std::optional<std::uint16_t> halfWord(std::uint32_t address) const;

  [[nodiscard]] std::uint32_t get(unsigned register_number) const;
  void set(unsigned register_number, std::uint32_t value);
  [[nodiscard]] std::uint32_t flags() const;
  void setFlags(std::uint32_t value);
  /// R0 to R3, R12, LR, as an exception stacks them.
  [[nodiscard]] std::array<std::uint32_t, 6> scratch() const;
  void setScratch(const std::array<std::uint32_t, 6>& values);

 private:
  static void onCode(uc_engine* engine, std::uint64_t address, std::uint32_t size, void* self);
  static void onException(uc_engine* engine, std::uint32_t number, void* self);
  static bool onBadMemory(uc_engine* engine, uc_mem_type type, std::uint64_t address, int size,
                          std::int64_t value, void* self);
  template <std::uint32_t kBase>
  static std::uint64_t onRead(uc_engine* engine, std::uint64_t offset, unsigned size, void* self);
  template <std::uint32_t kBase>
  static void onWrite(uc_engine* engine, std::uint64_t offset, unsigned size, std::uint64_t value,
                      void* self);
  template <std::uint32_t kBase>
  void mapDevices(std::uint32_t bytes);
  void mapMemory(std::uint32_t base, std::span<std::uint8_t> bytes, std::uint32_t permissions);

  void beforeInstruction(std::uint32_t pc, std::uint32_t size);
  [[nodiscard]] bool stopsAt(std::uint32_t pc, const Timing& timing, Cycle now);
  [[nodiscard]] Timing timingAt(std::uint32_t pc);
  [[nodiscard]] Cycle jumpCycles(std::uint32_t pc, std::uint32_t size);
  [[nodiscard]] Cycle afterFetch(Cycle now, std::uint32_t line);
  void beginIfThen(std::uint32_t pc);
  void watchLoop(std::uint32_t head, Cycle now);
  [[nodiscard]] Cycle afterIdleLoop(Cycle now);
  void repairFlash();

  Present& present_;
  CoreBus& bus_;
  std::span<std::uint8_t> flash_;
  std::span<std::uint8_t> sram_;
  uc_engine* engine_{};
  std::vector<Timing> timings_;  ///< A half-word of the flash each.
  Cycle limit_{};
  std::uint32_t pc_{};
  std::uint32_t expected_{};  ///< Address of the next instruction unless there is a branch.
  std::uint8_t last_load_{Timing::kNoRegister};
  std::uint8_t last_flags_{};
  std::uint32_t line_{};  ///< Line of the flash that is being executed, in units of 8 bytes.
  std::uint32_t next_line_{};
  Cycle next_line_at_{};
  unsigned wait_states_{};
  bool prefetches_{true};
  std::uint32_t if_then_{};  ///< Address of the last IT, and of the end of what it makes conditional.
  std::uint32_t if_then_end_{};
  /// The last branch backwards, whether an iteration stores or reaches devices, and how many did not.
  struct Loop {
    std::uint32_t head{};
    unsigned pure_iterations{};
    unsigned next_look{};
    Cycle began{};
    Cycle period{};
    std::array<std::uint32_t, 17> state{};
  };
  Loop loop_;
  bool has_effect_{};
  bool is_idle_{};
  std::optional<Stop> stop_;
  std::uint32_t fault_address_{};
  std::uint32_t exception_return_{};
  struct Repair {
    std::uint32_t offset{};
    std::array<std::uint8_t, 4> bytes{};
    unsigned size{};
  };
  std::vector<Repair> repairs_;
};

}  // namespace kerfbench::cortex_m_child
