// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench::mcs51_child {

/// What a controller holds after a program.
struct Memories {
  std::array<std::uint8_t, 256> iram{};
  std::array<std::uint8_t, 128> sfr{};
  std::vector<std::uint8_t> xram;
  std::uint64_t clocks{};
};

/// Debian's s51 of sdcc-ucsim, or empty if it is not installed.
std::string s51Program();

/// Runs 64 KiB of code on an 8032 under s51, from address 0 until it comes to `stop`. RAM is cleared before.
/// @throws std::runtime_error if s51 does not say what it should.
Memories runS51(const std::vector<std::uint8_t>& code, std::uint16_t stop);

/// The same on our own.
Memories runOurs(const std::vector<std::uint8_t>& code, std::uint16_t stop);

/// Writes a program as Intel HEX.
std::string intelHex(const std::vector<std::uint8_t>& code);

/// Feeds commands to s51 and returns what it prints.
std::string askS51(const std::string& options, const std::string& commands);

}  // namespace kerfbench::mcs51_child
