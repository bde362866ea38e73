// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::controller_test {

/// Appends the end of KB_CONFIG: each axis may go anywhere.
inline void appendNoField(std::vector<std::uint8_t>& config) {
  for (const std::int32_t end :
       {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()}) {
    for (int i = 0; i < 4 * KB_AXES; ++i)
      config.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(end) >> (8 * (i % 4))));
  }
}

/// Sets one axis' lowest and highest step in a whole KB_CONFIG.
inline void setField(std::vector<std::uint8_t>& config, int axis, std::int32_t lowest, std::int32_t highest) {
  auto at = static_cast<std::size_t>(KB_CONFIG_LEN - 8 * KB_AXES + 4 * axis);
  for (const std::int32_t end : {lowest, highest}) {
    for (unsigned i = 0; i < 4; ++i)
      config.at(at + i) = static_cast<std::uint8_t>(static_cast<std::uint32_t>(end) >> (8 * i));
    at += 4 * KB_AXES;
  }
}

}  // namespace kerfbench::controller_test
