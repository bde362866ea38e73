// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace kerfbench {

/// An image under simavr's own avr_run(), in this process and without a bench: what one would run otherwise.
struct SimavrRun {
  std::filesystem::path image;
  std::string mcu;
  std::uint32_t clock_hz{};
  /// What serves it best: 16 000 cycles at a time in place of one instruction, no look at pins of external
  /// interrupts in each cycle, no sleep of the process where the firmware asks its UART.
  bool is_tuned{};
};

/// Counters times_the_silicon and times_by_processor_time, as those of the emulators behind their pipes.
void runSimavr(benchmark::State& state, const SimavrRun& subject);

}  // namespace kerfbench
