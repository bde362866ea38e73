// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/image.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace kerfbench::avr_child {
namespace {

constexpr std::size_t kMaxFileBytes = 16U << 20U;
constexpr std::uint32_t kEepromAddress =
    0x810000;  // Where the GNU linker puts EEPROM in its one address space.
constexpr std::uint32_t kDataAddress = 0x800000;
constexpr std::string_view kElfMagic{
    "\x7f"
    "ELF"};

class Placer {
 public:
  Placer(std::string path, std::size_t flash_size, std::size_t eeprom_size)
      : path_(std::move(path)), eeprom_size_(eeprom_size) {
    image_.flash.assign(flash_size, 0xFF);
  }
  [[noreturn]] void fail(const std::string& where, const std::string& what) const {
    throw std::runtime_error(path_ + where + ": " + what);
  }
  /// From here on addresses below those of the linker are the EEPROM's as well.
  void placeInEeprom() { only_eeprom_ = true; }
  void place(std::uint64_t address, const std::uint8_t* bytes, std::size_t count, const std::string& where) {
    if (count == 0) return;
    auto* memory = &image_.flash;
    if (only_eeprom_ || address >= kEepromAddress) {
      address -= address >= kEepromAddress ? kEepromAddress : 0;
      if (image_.eeprom.empty()) image_.eeprom.assign(eeprom_size_, 0xFF);
      memory = &image_.eeprom;
    }
    if (address > memory->size() || count > memory->size() - address) {
      fail(where, "data at address " + std::to_string(address) + " is outside the controller's memory");
    }
    std::memcpy(memory->data() + address, bytes, count);
    if (memory == &image_.flash) flash_bytes_ += count;
  }
  std::vector<std::uint8_t> takeEeprom() {
    if (image_.eeprom.empty()) fail("", "the file holds nothing");
    return std::move(image_.eeprom);
  }
  Image take() {
    if (flash_bytes_ == 0) fail("", "the image holds no code");
    return std::move(image_);
  }

 private:
  std::string path_;
  std::size_t eeprom_size_;
  Image image_;
  std::size_t flash_bytes_{};
  bool only_eeprom_{};
};

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

void readHex(std::string_view text, Placer& placer) {
  std::uint64_t base = 0;
  bool ended = false;
  std::size_t line_number = 0;
  while (!text.empty()) {
    ++line_number;
    const std::string where = ":" + std::to_string(line_number);
    const auto eol = text.find('\n');
    std::string_view line = text.substr(0, eol);
    text.remove_prefix(eol == std::string_view::npos ? text.size() : eol + 1);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (line.empty()) continue;
    if (ended) placer.fail(where, "text after the end-of-file record");
    if (line.front() != ':') placer.fail(where, "a record must start with ':'");
    line.remove_prefix(1);
    std::vector<std::uint8_t> bytes;
    std::uint8_t sum = 0;
    for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
      const int high = hexDigit(line[i]);
      const int low = hexDigit(line[i + 1]);
      if (high < 0 || low < 0) placer.fail(where, "not a hexadecimal digit");
      bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
      sum = static_cast<std::uint8_t>(sum + bytes.back());
    }
    if (line.size() % 2 != 0 || bytes.size() < 5 || bytes.size() != 5U + bytes[0]) {
      placer.fail(where, "the record's length is wrong");
    }
    if (sum != 0) placer.fail(where, "bad checksum");
    const std::uint64_t offset = bytes[1] * 256U + bytes[2];
    const auto wide = [&] {
      if (bytes[0] != 2) placer.fail(where, "an address record must have two bytes");
      return bytes[4] * 256U + bytes[5];
    };
    switch (bytes[3]) {
      case 0:
        placer.place(base + offset, bytes.data() + 4, bytes[0], where);
        break;
      case 1:
        ended = true;
        break;
      case 2:
        base = std::uint64_t{wide()} << 4U;
        break;
      case 4:
        base = std::uint64_t{wide()} << 16U;
        break;
      case 3:
      case 5:
        break;  // Start address: an AVR starts at its reset vector.
      default:
        placer.fail(where, "unknown record type " + std::to_string(bytes[3]));
    }
  }
  if (!ended) placer.fail("", "no end-of-file record: the file is truncated");
}

std::uint32_t little(std::string_view bytes, std::size_t at, std::size_t size, const Placer& placer) {
  if (at > bytes.size() || size > bytes.size() - at) placer.fail("", "the ELF file is truncated");
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at + i])) << (8 * i);
  }
  return value;
}

/// The loadable segments by their load address, which is what a programmer writes.
void readElf(std::string_view bytes, Placer& placer) {
  constexpr std::uint32_t kMachineAvr = 83;
  constexpr std::uint32_t kLoad = 1;
  if (little(bytes, 4, 1, placer) != 1 || little(bytes, 5, 1, placer) != 1) {
    placer.fail("", "not a 32-bit little-endian ELF file");
  }
  if (little(bytes, 18, 2, placer) != kMachineAvr) placer.fail("", "the ELF file is not for an AVR");
  const std::size_t table = little(bytes, 28, 4, placer);
  const std::size_t entry_size = little(bytes, 42, 2, placer);
  const std::size_t entries = little(bytes, 44, 2, placer);
  if (entry_size < 32) placer.fail("", "the ELF file has no program headers");
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t header = table + i * entry_size;
    if (little(bytes, header, 4, placer) != kLoad) continue;
    const std::size_t offset = little(bytes, header + 4, 4, placer);
    const std::uint32_t address = little(bytes, header + 12, 4, placer);
    const std::size_t size = little(bytes, header + 16, 4, placer);
    if (size == 0 || (address >= kDataAddress && address < kEepromAddress)) continue;
    if (address >= kEepromAddress + 0x10000) continue;  // Fuses, lock bits, signature.
    little(bytes, offset, 0, placer);
    if (size > bytes.size() - offset) placer.fail("", "the ELF file is truncated");
    placer.place(address, reinterpret_cast<const std::uint8_t*>(bytes.data()) + offset, size,
                 ": segment " + std::to_string(i));
  }
}

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": " + std::strerror(errno));
  std::string bytes;
  char block[65536];
  while (file.read(block, sizeof block) || file.gcount() > 0) {
    bytes.append(block, static_cast<std::size_t>(file.gcount()));
    if (bytes.size() > kMaxFileBytes) throw std::runtime_error(path + ": larger than any AVR image");
  }
  if (file.bad()) throw std::runtime_error(path + ": " + std::strerror(errno));
  return bytes;
}

}  // namespace

Image readImage(const std::string& path, std::size_t flash_size, std::size_t eeprom_size) {
  const std::string bytes = contentOf(path);
  Placer placer(path, flash_size, eeprom_size);
  if (bytes.starts_with(kElfMagic)) {
    readElf(bytes, placer);
  } else {
    readHex(bytes, placer);
  }
  return placer.take();
}

std::vector<std::uint8_t> readEeprom(const std::string& path, std::size_t eeprom_size) {
  const std::string bytes = contentOf(path);
  Placer placer(path, 0, eeprom_size);
  placer.placeInEeprom();
  if (bytes.starts_with(':')) {
    readHex(bytes, placer);
  } else {
    placer.place(0, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), "");
  }
  return placer.takeEeprom();
}

}  // namespace kerfbench::avr_child
