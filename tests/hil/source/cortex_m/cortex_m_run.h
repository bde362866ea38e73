// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/hil/source/run_source.h"

namespace kerfbench::source::cortex_m {

inline constexpr PinId kPA0{0, 0};
inline constexpr Tick kMs = 72'000;  ///< Ticks of a controller of 72 MHz.

inline ChildSourceOptions optionsFor(std::string_view firmware) {
  ChildSourceOptions options;
  options.child = KERFBENCH_CORTEX_M_CHILD;
  options.image = std::string(KERFBENCH_CORTEX_M_IMAGES) + "/" + std::string(firmware) + ".elf";
  options.mcu = "stm32f103c8";
  options.clock_hz = 72'000'000;
  options.max_events_per_quantum = 100'000;
  return options;
}

/// Tests of images for the child; skipped where one of the two could not be built.
class CortexM : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(optionsFor("pulses").image))
      GTEST_SKIP() << "the images were not built: arm-none-eabi-gcc is missing";
  }
};

inline Run run(std::string_view firmware, Tick until, Tick quantum = kMs / 2) {
  const auto source = openChild(optionsFor(firmware));
  return runSource(*source, until, quantum);
}

inline Run runWith(const ChildSourceOptions& options, Tick until) {
  const auto source = openChild(options);
  return runSource(*source, until, kMs / 2);
}

/// The lines that the firmware has said.
inline std::vector<std::string> linesOf(const std::string& uart) {
  std::vector<std::string> lines;
  std::istringstream stream(uart);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Differences between neighbours.
inline std::vector<Tick> steps(const std::vector<Tick>& ticks) {
  std::vector<Tick> differences;
  for (std::size_t i = 1; i < ticks.size(); ++i) differences.push_back(ticks[i] - ticks[i - 1]);
  return differences;
}

}  // namespace kerfbench::source::cortex_m
