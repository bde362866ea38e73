// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/serial_pace.h"

#include <cmath>
#include <stdexcept>

namespace kerfbench::emulator {

void checkRates(const OpenRequest& asked, std::uint64_t most_hz) {
  const bool is_fit =
      asked.clock_hz > 0 && asked.clock_hz <= most_hz && asked.baud <= asked.clock_hz / kBitsPerByte;
  if (!is_fit) throw std::runtime_error("clock or baud rate out of range");
}

bool missesBytes(double rate, double asked) {
  constexpr double kMostOff = 0.5 / 9.5;
  if (asked == 0) return false;
  return std::abs(rate - asked) > kMostOff * asked;
}

}  // namespace kerfbench::emulator
