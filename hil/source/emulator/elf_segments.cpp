// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/elf_segments.h"

namespace kerfbench::emulator {
namespace {

constexpr std::string_view kElfMagic{
    "\x7f"
    "ELF"};

/// Little-endian fields of an ELF file.
class Fields {
 public:
  Fields(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}
  [[nodiscard]] std::uint32_t at(std::size_t offset, std::size_t size) const {
    const std::string_view field = part(offset, size);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(field[i])) << (8 * i);
    return value;
  }
  [[nodiscard]] std::string_view part(std::size_t offset, std::size_t size) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset)
      refuseImage(path_, "", "the ELF file is truncated");
    return bytes_.substr(offset, size);
  }

 private:
  std::string_view bytes_;
  const std::string& path_;
};

}  // namespace

bool isElf(std::string_view bytes) { return bytes.starts_with(kElfMagic); }

void readElfSegments(std::string_view bytes, const std::string& path, std::uint32_t machine,
                     std::string_view machine_name, const Placer& place) {
  constexpr std::uint32_t kLoad = 1;
  const Fields elf(bytes, path);
  if (elf.at(4, 1) != 1 || elf.at(5, 1) != 1) refuseImage(path, "", "not a 32-bit little-endian ELF file");
  if (elf.at(18, 2) != machine) refuseImage(path, "", "the ELF file is not for " + std::string(machine_name));
  const std::size_t table = elf.at(28, 4);
  const std::size_t entry_size = elf.at(42, 2);
  const std::size_t entries = elf.at(44, 2);
  if (entry_size < 32) refuseImage(path, "", "the ELF file has no program headers");
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t header = table + i * entry_size;
    const std::uint32_t size = elf.at(header + 16, 4);
    if (elf.at(header, 4) != kLoad || size == 0) continue;
    const std::string_view content = elf.part(elf.at(header + 4, 4), size);
    place(elf.at(header + 12, 4), {reinterpret_cast<const std::uint8_t*>(content.data()), content.size()},
          ": segment " + std::to_string(i));
  }
}

}  // namespace kerfbench::emulator
