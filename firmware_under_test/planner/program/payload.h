// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kerfbench::planner {

/// Bytes of an operation or of a payload, as they go down the UART.
using Payload = std::vector<std::uint8_t>;

/// Appends the lowest `bytes` bytes of a number, the lowest first.
inline void append(Payload& payload, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) payload.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

}  // namespace kerfbench::planner
