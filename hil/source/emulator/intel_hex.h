// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "hil/source/emulator/image_file.h"

namespace kerfbench::emulator {

/// Reads Intel HEX (Intel 1988), with its extended addresses of segments and of 32 bits. Everything is
/// checked: a file that a programmer would refuse is refused. Start addresses are passed over.
/// @throws std::runtime_error with `path` and the line.
void readIntelHex(std::string_view text, const std::string& path, const Placer& place);

}  // namespace kerfbench::emulator
