// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "hil/source/emulator/elf_segments.h"
#include "hil/source/emulator/image_file.h"
#include "hil/source/emulator/intel_hex.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {
namespace {

/// The flash of a controller; what does not fit is refused as an emulator refuses it.
emulator::Placer flash(const std::string& path) {
  return [path](std::uint64_t address, std::span<const std::uint8_t> bytes, const std::string& where) {
    static std::array<std::uint8_t, 256 * 1024> memory;
    if (address > memory.size() || bytes.size() > memory.size() - address)
      emulator::refuseImage(path, where, "has no place in the memory");
    for (std::size_t i = 0; i < bytes.size(); ++i) memory[static_cast<std::size_t>(address) + i] = bytes[i];
  };
}

}  // namespace

bool imageHex(Bytes bytes) {
  return takes<std::runtime_error>([&] {
    const std::string path = asFile("image.hex", bytes).string();
    emulator::readIntelHex(emulator::imageContent(path), path, flash(path));
  });
}

/// As an image for either kind of controller.
bool imageElf(Bytes bytes) {
  const std::string path = asFile("image.elf", bytes).string();
  bool is_taken = false;
  for (const std::uint32_t machine : {emulator::kElfMachineArm, emulator::kElfMachineAvr}) {
    is_taken = takes<std::runtime_error>([&] {
                 const std::string content = emulator::imageContent(path);
                 if (!emulator::isElf(content)) throw std::runtime_error("is no ELF");
                 emulator::readElfSegments(content, path, machine, "controller", flash(path));
               }) ||
               is_taken;
  }
  return is_taken;
}

}  // namespace kerfbench::fuzz
