// SPDX-License-Identifier: Apache-2.0
#include "hil/source/mcs51_child/part.h"

namespace kerfbench::mcs51_child {
namespace {

// Machine cycles by opcode, sixteen to a line: the column is the low digit (Intel 1994, table 10 of chapter
// 2).
constexpr ClockTable kMachineCycles{
    1, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 0x
    2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 1x
    2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 2x
    2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 3x
    2, 2, 1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 4x
    2, 2, 1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 5x
    2, 2, 1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 6x
    2, 2, 2, 2, 1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 7x
    2, 2, 2, 2, 4, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2,  // 8x
    2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // 9x
    2, 2, 1, 2, 4, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2,  // Ax
    2, 2, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2,  // Bx
    2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // Cx
    2, 2, 1, 1, 1, 2, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2,  // Dx
    2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // Ex
    2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  // Fx
};

// Clocks by opcode of the STC-Y5. A jump takes the same time whether it is taken or not.
constexpr ClockTable kStcY5{
    1, 3, 4, 1, 1, 3, 3, 3, 2, 2, 2, 2, 2, 2, 2, 2,  // 0x
    5, 4, 4, 1, 1, 3, 3, 3, 2, 2, 2, 2, 2, 2, 2, 2,  // 1x
    5, 3, 4, 1, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // 2x
    5, 4, 4, 1, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // 3x
    3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // 4x
    3, 4, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // 5x
    4, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // 6x
    4, 4, 2, 5, 2, 3, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2,  // 7x
    3, 3, 2, 4, 6, 3, 3, 3, 2, 2, 2, 2, 2, 2, 2, 2,  // 8x
    3, 4, 3, 5, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // 9x
    2, 3, 2, 1, 2, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3,  // Ax
    2, 4, 3, 1, 4, 5, 5, 5, 4, 4, 4, 4, 4, 4, 4, 4,  // Bx
    3, 3, 3, 1, 1, 3, 3, 3, 2, 2, 2, 2, 2, 2, 2, 2,  // Cx
    2, 4, 3, 1, 3, 5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4,  // Dx
    2, 3, 3, 3, 1, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // Ex
    3, 4, 4, 4, 1, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1,  // Fx
};

constexpr ClockTable times(const ClockTable& cycles, unsigned factor) {
  ClockTable clocks{};
  for (std::size_t i = 0; i < clocks.size(); ++i) clocks[i] = static_cast<std::uint8_t>(cycles[i] * factor);
  return clocks;
}

constexpr ClockTable kTwelve = times(kMachineCycles, 12);

}  // namespace

const ClockTable& twelveClocks() { return kTwelve; }
const ClockTable& stc15Clocks() { return kStcY5; }

}  // namespace kerfbench::mcs51_child
