// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kerfbench::controller {

/// A frame of the controller around TYPE … payload, its CRC by the reference algorithm.
std::vector<std::uint8_t> spokenFrame(std::vector<std::uint8_t> body);

/// KB_STATE; the belt at 0x01020300 + `belt`, axes at 0 … 4.
std::vector<std::uint8_t> spokenState(std::uint8_t state, std::uint8_t fault, std::uint8_t belt);

}  // namespace kerfbench::controller
