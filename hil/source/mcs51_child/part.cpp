// SPDX-License-Identifier: Apache-2.0
#include "hil/source/mcs51_child/part.h"

#include <algorithm>
#include <stdexcept>

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint8_t kPorts0To3 = 0x0F;
constexpr std::uint8_t kPorts1And3 = 0x0A;  // The bus to external memories takes ports 0 and 2.
constexpr std::uint8_t kPorts0To5 = 0x3F;

constexpr Part stc15(std::string_view names, std::uint32_t code_bytes) {
  return {.names = names,
          .is_stc15 = true,
          .code_bytes = code_bytes,
          .iram_bytes = 256,
          .xram_bytes = 1792,
          .ports = kPorts0To5,
          .has_second_dptr = true,
          .wakes_by_interrupt = true};
}

/// Pins of the PWM are inputs after a reset.
constexpr Part stc15w4k(std::string_view names, std::uint32_t code_bytes) {
  Part part = stc15(names, code_bytes);
  part.xram_bytes = 3840;
  part.listens_after_reset = {0xC0, 0xC0, 0x8E, 0x80, 0x34, 0x00};
  return part;
}

// Memories by the data sheets (Intel 1994; Atmel 2008, and those of the AT89C51, AT89C52 and AT89S51; STC
// 2015).
constexpr Part kParts[] = {
    {.names = "80c31 8031",
     .code_bytes = 65536,
     .iram_bytes = 128,
     .xram_bytes = 65536,
     .ports = kPorts1And3},
    {.names = "80c32 8032",
     .code_bytes = 65536,
     .iram_bytes = 256,
     .xram_bytes = 65536,
     .ports = kPorts1And3,
     .has_timer2 = true},
    {.names = "80c51 8051 87c51 8751", .code_bytes = 4096, .iram_bytes = 128, .ports = kPorts0To3},
    {.names = "80c52 8052 87c52 8752",
     .code_bytes = 8192,
     .iram_bytes = 256,
     .ports = kPorts0To3,
     .has_timer2 = true},
    {.names = "at89c51", .code_bytes = 4096, .iram_bytes = 128, .ports = kPorts0To3},
    {.names = "at89c52",
     .code_bytes = 8192,
     .iram_bytes = 256,
     .ports = kPorts0To3,
     .has_timer2 = true,
     .has_clock_out = true},
    {.names = "at89s51",
     .code_bytes = 4096,
     .iram_bytes = 128,
     .ports = kPorts0To3,
     .has_watchdog = true,
     .has_second_dptr = true,
     .wakes_by_interrupt = true},
    {.names = "at89s52",
     .code_bytes = 8192,
     .iram_bytes = 256,
     .ports = kPorts0To3,
     .has_timer2 = true,
     .has_clock_out = true,
     .has_watchdog = true,
     .has_second_dptr = true,
     .wakes_by_interrupt = true},
    stc15("stc15f2k08s2", 8192),
    stc15("stc15f2k16s2", 16384),
    stc15("stc15f2k32s2", 32768),
    stc15("stc15f2k60s2", 61440),
    stc15w4k("stc15w4k16s4", 16384),
    stc15w4k("stc15w4k32s4", 32768),
};

std::string digitsOf(unsigned bits) {
  std::string digits;
  for (unsigned i = 0; bits >> i != 0; ++i) {
    if ((bits >> i & 1U) != 0) digits += std::to_string(i);
  }
  return digits;
}

std::string describe(const Part& part) {
  const bool has_three_timers = part.has_timer2 || part.is_stc15;
  return std::string(part.names) + "\t" + std::to_string(part.code_bytes) + "\t" +
         std::to_string(part.iram_bytes + part.xram_bytes) + "\t0\t" + digitsOf(part.ports) + "\t" +
         (has_three_timers ? "012" : "01") + "\t0\n";
}

}  // namespace

bool Part::isCalled(std::string_view name) const {
  std::string_view rest = names;
  while (!rest.empty()) {
    const auto end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

std::string Part::firstName() const { return std::string(names.substr(0, names.find(' '))); }

std::span<const Part> parts() { return kParts; }

const Part& partCalled(std::string_view name) {
  const auto* part = std::ranges::find_if(kParts, [&](const Part& each) { return each.isCalled(name); });
  if (part != std::end(kParts)) return *part;
  throw std::runtime_error("kerfbench-mcs51 has no controller '" + std::string(name) + "'");
}

std::string describeControllers(const std::string& name) {
  std::string all;
  for (const Part& part : kParts) {
    if (part.isCalled(name)) return describe(part);
    all += describe(part);
  }
  return all;
}

}  // namespace kerfbench::mcs51_child
