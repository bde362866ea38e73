// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hil/source/emulator/image_file.h"

namespace kerfbench::emulator {

/// Machines of ELF's e_machine (TIS 1995).
inline constexpr std::uint32_t kElfMachineArm = 40, kElfMachineAvr = 83;

/// Whether a file begins as ELF does.
[[nodiscard]] bool isElf(std::string_view bytes);

/// The loadable segments of a 32-bit little-endian ELF file by their load address, which is what a programmer
/// writes; empty ones are passed over. `machine_name` stands in the refusal of a file for another machine
/// ("the ELF file is not for an AVR"). @throws std::runtime_error with `path`.
void readElfSegments(std::string_view bytes, const std::string& path, std::uint32_t machine,
                     std::string_view machine_name, const Placer& place);

}  // namespace kerfbench::emulator
