// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/image.h"

#include <cstdio>
#include <cstring>
#include <span>

#include "hil/source/cortex_m_child/memory_map.h"
#include "hil/source/emulator/elf_segments.h"
#include "hil/source/emulator/image_file.h"
#include "hil/source/emulator/intel_hex.h"

namespace kerfbench::cortex_m_child {
namespace {

using emulator::refuseImage;

class Flash {
 public:
  Flash(const std::string& path, const Part& part) : path_(path), bytes_(part.flash_bytes, 0xFF) {}

  void place(std::uint64_t address, std::span<const std::uint8_t> bytes, const std::string& where) {
    if (bytes.empty()) return;
    // The flash is at address 0 as well; some linkers place it there.
    const std::uint64_t offset = address < bytes_.size() ? address : address - kFlashBase;
    if (offset > bytes_.size() || bytes.size() > bytes_.size() - offset)
      refuseImage(path_, where,
                  "data at address " + hex32(address) + " is outside the part's flash of " +
                      std::to_string(bytes_.size()) + " bytes");
    std::memcpy(bytes_.data() + offset, bytes.data(), bytes.size());
    placed_ += bytes.size();
  }

  [[nodiscard]] std::uint32_t word(std::size_t offset) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  std::vector<std::uint8_t> take(const Part& part) {
    if (placed_ == 0) refuseImage(path_, "", "the image holds no code");
    checkVectors(part);
    return std::move(bytes_);
  }

 private:
  void checkVectors(const Part& part) const {
    const std::uint32_t stack = word(0);
    const std::uint32_t start = word(4);
    if (stack <= kSramBase || stack > kSramBase + part.sram_bytes || stack % 4 != 0)
      refuseImage(path_, "",
                  "the first word, " + hex32(stack) +
                      ", is no stack pointer in the part's SRAM: not an image for this part");
    if (start % 2 == 0)
      refuseImage(
          path_, "",
          "the reset vector, " + hex32(start) + ", lacks the bit of Thumb: not an image for Cortex-M");
    if (start - kFlashBase >= part.flash_bytes && start >= part.flash_bytes)
      refuseImage(path_, "", "the reset vector, " + hex32(start) + ", is outside the part's flash");
  }

  const std::string& path_;
  std::vector<std::uint8_t> bytes_;
  std::size_t placed_{};
};

}  // namespace

std::string hex32(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%08llx", static_cast<unsigned long long>(value));
  return text;
}

std::vector<std::uint8_t> readFlash(const std::string& path, const Part& part) {
  const std::string bytes = emulator::imageContent(path);
  Flash flash(path, part);
  const auto place = [&flash](auto... at) { flash.place(at...); };
  if (emulator::isElf(bytes)) {
    emulator::readElfSegments(bytes, path, emulator::kElfMachineArm, "an ARM", place);
  } else if (bytes.starts_with(':')) {
    emulator::readIntelHex(bytes, path, place);
  } else {
    flash.place(kFlashBase, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "");
  }
  return flash.take(part);
}

}  // namespace kerfbench::cortex_m_child
