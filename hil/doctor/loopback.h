// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/loop_back.h"
#include "hil/source/gpio/pulse_train.h"

namespace kerfbench::doctor {

/// Options of a measurement on lines that are wired to each other.
struct LoopbackOptions {
  bool wanted{};
  std::string loop_back;  ///< "OUT=IN": numbers or names of lines.
  std::string chip;       ///< IN's, by path, name or label; empty: the only one.
  std::string out_chip;   ///< OUT's; empty: `chip`.
  std::string beside;     ///< Free line of `chip` that is read too; empty: the first free input.
  std::vector<double> rates_hz{200, 1'000, 2'000, 5'000, 10'000, 20'000, 40'000, 80'000, 160'000};
  double seconds{1.0};  ///< Time for each rate.
};

/// Measurement on a loop-back, and the computer it was made on.
struct BenchReport {
  std::string kernel;           ///< "Linux 6.1.0-18-amd64".
  std::string clock_source;     ///< Clock of the kernel: "tsc"; empty: it does not say.
  std::string virtual_machine;  ///< Sign of a virtual machine; empty: none.
  source::LoopBackLines lines;
  std::vector<std::string> real_time_notes;  ///< Rights that lack, and how to grant them.
  std::vector<source::LoopBackStep> steps;   ///< Steps in order of their rates.
};

/// The lines that the options name. @throws GpioError with everything that is wrong with them.
source::LoopBackLines chosenLines(const LoopbackOptions& options, const source::GpioChipList& chips);

/// Makes edges at growing rates until some are lost or the output can go no faster. The thread has real-time
/// priority meanwhile, as far as it is allowed. @throws GpioError: lines cannot be had, the input does not
/// follow the output, a chip that vanishes.
void measureRates(const std::shared_ptr<source::GpioSystem>& system, source::EdgeTrain& train,
                  const LoopbackOptions& options, BenchReport& report);

/// Fastest that lost nothing; null: none.
const source::LoopBackStep* sustained(const BenchReport& report);

/// Value for a scenario's firmware.stamp_err_us: no edge of the rates that were held was stamped later than
/// this.
struct StampBound {
  std::uint64_t edges{};
  std::uint32_t stamp_err_us{};  ///< Rounded up.
};
/// nullopt: no rate was held.
std::optional<StampBound> stampBound(const BenchReport& report);

/// Report for people, and as JSON.
std::string benchText(const BenchReport& report);
std::string benchJson(const BenchReport& report);

/// `doctor --bench`. Returns 0, or 1 with what is wrong on standard error.
int measureLoopback(const LoopbackOptions& options, bool json);

}  // namespace kerfbench::doctor
