// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/app/commands.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/loop_back.h"
#include "hil/source/gpio/pulse_train.h"

namespace kerfbench::hil {

/// What was measured on a loop-back, and where.
struct BenchReport {
  std::string kernel;           ///< "Linux 6.1.0-18-amd64".
  std::string clock_source;     ///< Of the kernel: "tsc"; empty: it does not say.
  std::string virtual_machine;  ///< By what it shows that this is one; empty: a machine.
  LoopBackLines lines;
  std::vector<std::string> real_time_notes;  ///< What is not allowed, and how to allow it.
  std::vector<LoopBackStep> steps;           ///< In order of their rates.
};

/// The lines that the options name. @throws GpioError with everything that is wrong with them.
LoopBackLines chosenLines(const BenchOptions& options, const GpioChipList& chips);

/// Makes edges at growing rates until some are lost or the output can go no faster. The thread has real-time
/// priority meanwhile, as far as it is allowed. @throws GpioError: lines cannot be had, the input does not
/// follow the output, a chip that vanishes.
void measureRates(const std::shared_ptr<GpioSystem>& system, EdgeTrain& train, const BenchOptions& options,
                  BenchReport& report);

/// Fastest that lost nothing; null: none.
const LoopBackStep* sustained(const BenchReport& report);

/// For a scenario's firmware.stamp_err_us: no edge of the rates that were held was stamped later than this.
struct StampBound {
  std::uint64_t edges{};
  std::uint32_t stamp_err_us{};  ///< Rounded up.
};
/// nullopt: no rate was held.
std::optional<StampBound> stampBound(const BenchReport& report);

/// For people, and as JSON.
std::string benchText(const BenchReport& report);
std::string benchJson(const BenchReport& report);

/// `doctor --bench`. Returns 0, or 1 with what is wrong on standard error.
int loopBackCommand(const DoctorOptions& options);

}  // namespace kerfbench::hil
