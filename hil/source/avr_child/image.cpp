// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/image.h"

#include <cstring>
#include <span>

#include "hil/source/emulator/elf_segments.h"
#include "hil/source/emulator/image_file.h"
#include "hil/source/emulator/intel_hex.h"

namespace kerfbench::avr_child {
namespace {

// The GNU linker has one address space for all memories: data, then EEPROM, then fuses, lock bits and
// signature.
constexpr std::uint64_t kDataAddress = 0x800000;
constexpr std::uint64_t kEepromAddress = 0x810000;
constexpr std::uint64_t kFuseAddress = 0x820000;

class Memories {
 public:
  Memories(std::string path, std::size_t flash_size, std::size_t eeprom_size)
      : path_(std::move(path)), eeprom_size_(eeprom_size) {
    image_.flash.assign(flash_size, 0xFF);
  }
  /// From here on addresses below those of the linker are the EEPROM's as well.
  void placeInEeprom() { only_eeprom_ = true; }
  void place(std::uint64_t address, std::span<const std::uint8_t> bytes, const std::string& where) {
    if (bytes.empty()) return;
    auto* memory = &image_.flash;
    if (only_eeprom_ || address >= kEepromAddress) {
      address -= address >= kEepromAddress ? kEepromAddress : 0;
      if (image_.eeprom.empty()) image_.eeprom.assign(eeprom_size_, 0xFF);
      memory = &image_.eeprom;
    }
    if (address > memory->size() || bytes.size() > memory->size() - address) {
      emulator::refuseImage(
          path_, where, "data at address " + std::to_string(address) + " is outside the controller's memory");
    }
    std::memcpy(memory->data() + address, bytes.data(), bytes.size());
    if (memory == &image_.flash) flash_bytes_ += bytes.size();
  }
  void placeSegment(std::uint64_t address, std::span<const std::uint8_t> bytes, const std::string& where) {
    const bool is_data = address >= kDataAddress && address < kEepromAddress;
    if (!is_data && address < kFuseAddress) place(address, bytes, where);
  }
  void placeHex(std::string_view text) {
    emulator::readIntelHex(text, path_, [this](auto... record) { place(record...); });
  }
  void placeElf(std::string_view bytes) {
    emulator::readElfSegments(bytes, path_, emulator::kElfMachineAvr, "an AVR",
                              [this](auto... segment) { placeSegment(segment...); });
  }
  std::vector<std::uint8_t> takeEeprom() {
    if (image_.eeprom.empty()) emulator::refuseImage(path_, "", "the file holds nothing");
    return std::move(image_.eeprom);
  }
  Image take() {
    if (flash_bytes_ == 0) emulator::refuseImage(path_, "", "the image holds no code");
    return std::move(image_);
  }

 private:
  std::string path_;
  std::size_t eeprom_size_;
  Image image_;
  std::size_t flash_bytes_{};
  bool only_eeprom_{};
};

}  // namespace

Image readImage(const std::string& path, std::size_t flash_size, std::size_t eeprom_size) {
  const std::string bytes = emulator::imageContent(path);
  Memories memories(path, flash_size, eeprom_size);
  if (emulator::isElf(bytes)) {
    memories.placeElf(bytes);
  } else {
    memories.placeHex(bytes);
  }
  return memories.take();
}

std::vector<std::uint8_t> readEeprom(const std::string& path, std::size_t eeprom_size) {
  const std::string bytes = emulator::imageContent(path);
  Memories memories(path, 0, eeprom_size);
  memories.placeInEeprom();
  if (bytes.starts_with(':')) {
    memories.placeHex(bytes);
  } else {
    memories.place(0, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "");
  }
  return memories.takeEeprom();
}

}  // namespace kerfbench::avr_child
