// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kerfbench::controller {

/// Frame of the controller around TYPE … payload, with its CRC by the reference algorithm.
std::vector<std::uint8_t> spokenFrame(std::vector<std::uint8_t> body);

/// Frame KB_STATE; the belt at 0x01020300 + `belt`, axes at 0 … 4.
std::vector<std::uint8_t> spokenState(std::uint8_t state, std::uint8_t fault, std::uint8_t belt);

}  // namespace kerfbench::controller
