// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/rcc.h"

namespace kerfbench::cortex_m_child {

/// Addresses of devices and memories, as core and DMA see them.
class Bus {
 public:
  struct Slot {
    std::uint32_t base{};
    Device* device{};  ///< Null: the silicon has it, and it is not modelled.
    ClockBus bus{};
    unsigned clock_bit{};
    std::string name;
  };

  Bus(Present& present, const Rcc& rcc, std::span<std::uint8_t> flash, std::span<std::uint8_t> sram)
      : present_(present), rcc_(rcc), flash_(flash), sram_(sram) {}
  void add(Slot slot);
  [[nodiscard]] std::span<const Slot> slots() const { return slots_; }

  /// An access to a device, or to the bit that an alias stands for. A device whose clock is off reads 0 and
  /// takes no notice. Nothing where the silicon would answer with a bus fault.
  std::optional<std::uint32_t> read(std::uint32_t address, unsigned bytes);
  bool write(std::uint32_t address, unsigned bytes, std::uint32_t value);
  /// An access of the DMA, to memories as well.
  std::optional<std::uint32_t> readAny(std::uint32_t address, unsigned bytes);
  bool writeAny(std::uint32_t address, unsigned bytes, std::uint32_t value);
  /// Cycles that the core waits for a device: a clock of its bus.
  [[nodiscard]] Cycle waitCycles(std::uint32_t address) const;

 private:
  [[nodiscard]] const Slot* slotAt(std::uint32_t address) const;
  [[nodiscard]] bool isSilent(const Slot& slot, std::uint32_t address, const char* verb);
  std::optional<std::uint32_t> readBit(std::uint32_t address);
  bool writeBit(std::uint32_t address, std::uint32_t value);

  Present& present_;
  const Rcc& rcc_;
  std::span<std::uint8_t> flash_;
  std::span<std::uint8_t> sram_;
  std::vector<Slot> slots_;
  static constexpr std::uint8_t kNone = 0xFF;
  std::vector<std::uint8_t> at_;  ///< Index of the slot of each KiB of the devices.
};

}  // namespace kerfbench::cortex_m_child
