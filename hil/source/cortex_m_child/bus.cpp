// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/bus.h"

#include <cstring>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kSlotBytes = 0x400;
constexpr std::uint32_t kApb2Base = 0x40010000, kAhbBase = 0x40018000;

constexpr std::uint32_t sizeMask(unsigned bytes) {
  return bytes >= 4 ? 0xFFFFFFFFU : (1U << (8 * bytes)) - 1U;
}

/// What a word's register gets by an access of a part of it: the bridge repeats the part in all of the word
/// (RM0008, Memory organization).
constexpr std::uint32_t repeated(std::uint32_t value, unsigned bytes) {
  if (bytes == 1) return (value & 0xFFU) * 0x01010101U;
  return bytes == 2 ? (value & 0xFFFFU) * 0x00010001U : value;
}

bool isAlias(std::uint32_t address, std::uint32_t alias_base, std::uint32_t bytes) {
  return address >= alias_base && address - alias_base < bytes * 32;
}

}  // namespace

void Bus::add(Slot slot) {
  if (at_.empty()) at_.assign(kDeviceBytes / kSlotBytes + 1, kNone);
  const std::size_t place =
      slot.base == kSystemBase ? at_.size() - 1 : (slot.base - kDeviceBase) / kSlotBytes;
  at_.at(place) = static_cast<std::uint8_t>(slots_.size());
  slots_.push_back(std::move(slot));
}

const Bus::Slot* Bus::slotAt(std::uint32_t address) const {
  std::uint8_t index = kNone;
  if (address - kDeviceBase < kDeviceBytes) index = at_[(address - kDeviceBase) / kSlotBytes];
  if (address - kSystemBase < kSystemBytes) index = at_.back();
  return index == kNone ? nullptr : &slots_[index];
}

Cycle Bus::waitCycles(std::uint32_t address) const {
  if (isAlias(address, kDeviceAliasBase, kDeviceBytes))
    return 2 * waitCycles(kDeviceBase + (address - kDeviceAliasBase) / 32);
  if (address - kDeviceBase < kApb2Base - kDeviceBase) return rcc_.divider(ClockBus::kApb1);
  if (address - kApb2Base < kAhbBase - kApb2Base) return rcc_.divider(ClockBus::kApb2);
  return 0;
}

/// Whether nothing happens because the device has no clock; one that is not modelled ends the run otherwise.
bool Bus::isSilent(const Slot& slot, std::uint32_t address, const char* verb) {
  if (!rcc_.isOn(slot.bus, slot.clock_bit)) return true;
  if (slot.device == nullptr)
    present_.refuse("the firmware " + std::string(verb) + " " + slot.name + " at " + hex32(address));
  return slot.device == nullptr;
}

std::optional<std::uint32_t> Bus::readBit(std::uint32_t address) {
  const bool is_sram = address < kDeviceAliasBase;
  const std::uint32_t bit = (address - (is_sram ? kSramAliasBase : kDeviceAliasBase)) / 4;
  const std::uint32_t target = (is_sram ? kSramBase : kDeviceBase) + (bit / 32) * 4;
  const auto word = readAny(target, 4);
  return word ? std::optional(*word >> (bit % 32) & 1U) : std::nullopt;
}

bool Bus::writeBit(std::uint32_t address, std::uint32_t value) {
  const bool is_sram = address < kDeviceAliasBase;
  const std::uint32_t bit = (address - (is_sram ? kSramAliasBase : kDeviceAliasBase)) / 4;
  const std::uint32_t target = (is_sram ? kSramBase : kDeviceBase) + (bit / 32) * 4;
  const auto word = readAny(target, 4);
  if (!word) return false;
  const std::uint32_t mask = 1U << (bit % 32);
  return writeAny(target, 4, (value & 1U) != 0 ? *word | mask : *word & ~mask);
}

std::optional<std::uint32_t> Bus::read(std::uint32_t address, unsigned bytes) {
  if (isAlias(address, kSramAliasBase, static_cast<std::uint32_t>(sram_.size())) ||
      isAlias(address, kDeviceAliasBase, kDeviceBytes))
    return readBit(address);
  const Slot* slot = slotAt(address);
  if (slot == nullptr) return std::nullopt;
  if (isSilent(*slot, address, "reads")) return 0;
  const std::uint32_t word = slot->device->read((address - slot->base) & ~3U);
  return word >> (8 * (address & 3U)) & sizeMask(bytes);
}

bool Bus::write(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (isAlias(address, kSramAliasBase, static_cast<std::uint32_t>(sram_.size())) ||
      isAlias(address, kDeviceAliasBase, kDeviceBytes))
    return writeBit(address, value);
  const Slot* slot = slotAt(address);
  if (slot == nullptr) return false;
  if (isSilent(*slot, address, "writes")) return true;
  const std::uint32_t offset = (address - slot->base) & ~3U;
  if (address >= kSystemBase && bytes < 4) {  // The core's own registers take parts of a word as such.
    const unsigned shift = 8 * (address & 3U);
    const std::uint32_t mask = sizeMask(bytes) << shift;
    slot->device->write(offset, (slot->device->read(offset) & ~mask) | (value << shift & mask));
  } else {
    slot->device->write(offset, repeated(value, bytes));
  }
  return true;
}

std::optional<std::uint32_t> Bus::readAny(std::uint32_t address, unsigned bytes) {
  std::uint32_t value = 0;
  for (const auto& [base, memory] : {std::pair{kSramBase, sram_}, {kFlashBase, flash_}}) {
    if (address - base >= memory.size() || memory.size() - (address - base) < bytes) continue;
    std::memcpy(&value, memory.data() + (address - base), bytes);
    return value;
  }
  return read(address, bytes);
}

bool Bus::writeAny(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (address - kSramBase >= sram_.size()) return write(address, bytes, value);
  if (sram_.size() - (address - kSramBase) < bytes) return false;
  std::memcpy(sram_.data() + (address - kSramBase), &value, bytes);
  return true;
}

}  // namespace kerfbench::cortex_m_child
