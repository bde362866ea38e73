// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/parts.h"

namespace kerfbench::cortex_m_child {

/// Content of the part's flash with this image in it; bytes that it does not set are 0xFF, as after an erase.
/// Reads ELF by its magic, Intel HEX by a colon at its beginning, and takes anything else for the flash byte
/// by byte from its start. @throws std::runtime_error with the file, and the line of a HEX file, if it does
/// not fit, is for another machine, or has no vector table that a Cortex-M3 could start from.
std::vector<std::uint8_t> readFlash(const std::string& path, const Part& part);

}  // namespace kerfbench::cortex_m_child
