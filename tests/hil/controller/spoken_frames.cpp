// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/controller/spoken_frames.h"

namespace kerfbench::controller {

std::vector<std::uint8_t> spokenFrame(std::vector<std::uint8_t> body) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : body) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool top = (crc >> 15 & 1U) != (static_cast<unsigned>(byte) >> bit & 1U);
      crc = (crc << 1 & 0xFFFFU) ^ (top ? 0x1021U : 0U);
    }
  }
  body.insert(body.begin(), 0xA5);
  body.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  body.push_back(static_cast<std::uint8_t>(crc >> 8));
  return body;
}

std::vector<std::uint8_t> spokenState(std::uint8_t state, std::uint8_t fault, std::uint8_t belt) {
  std::vector<std::uint8_t> body{0x84, 1, 28, state, fault, 0, 0, belt, 3, 2, 1};
  for (std::uint8_t axis = 0; axis < 5; ++axis) {
    for (const std::uint8_t byte : {axis, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}}) {
      body.push_back(byte);
    }
  }
  return spokenFrame(body);
}

}  // namespace kerfbench::controller
