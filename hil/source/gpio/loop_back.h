// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/source/gpio/chip_lines.h"
#include "hil/source/gpio/pulse_train.h"
#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// An output line that is wired to an input line (a jumper), to measure how the bench reads edges.
struct LoopBackLines {
  std::filesystem::path out_chip;
  ChipLine out;
  std::filesystem::path in_chip;
  ChipLine in;
  /// Any free line of `in_chip`, read too because a run reads several lines in one request.
  ChipLine beside;
};

/// The worst of many times, what 95 % of them do not exceed, and the root of the mean square.
struct TimeSpread {
  std::uint64_t worst_ns{};
  std::uint64_t share95_ns{};
  double rms_ns{};
};
/// All zero without times.
TimeSpread spreadOf(std::vector<std::uint64_t> times_ns);

/// One rate of a loop-back.
struct LoopBackStep {
  double asked_hz{};   ///< Edges in a second.
  double driven_hz{};  ///< Edges in a second, as they were put out.
  std::uint64_t driven{};
  std::uint64_t read{};
  std::uint64_t beside{};  ///< Edges of the free line that is read too, which nobody drives.
  /// Problems in words; empty: each edge that was driven was read, once and in order.
  std::vector<std::string> problems;
  /// Delay of the kernel's stamp behind the change of the line. The time of the change is known to the length
  /// of a call, so each stamp's error lies between two bounds; these are the spreads of both. Without
  /// problems only.
  TimeSpread stamp_least;
  TimeSpread stamp_most;
  std::uint64_t worst_read_ns{};  ///< Longest time from stamp to read.
  std::int64_t worst_put_ns{};    ///< Longest time from plan to line, of the edges put out.
  double cpu_share{};             ///< Share of one processor, by the thread that reads.

  [[nodiscard]] bool held() const { return problems.empty(); }
  /// Whether the edges came as fast as they were asked for.
  [[nodiscard]] bool wasDriven() const { return driven_hz >= 0.95 * asked_hz; }
};

/// Reason why the input does not follow the output, in words; empty: it does. Leaves the output low.
/// @throws GpioError as LineRequest, or from `train`.
std::string wireTrouble(const std::shared_ptr<GpioSystem>& system, const LoopBackLines& lines,
                        EdgeTrain& train);

/// Reads the edges of one plan as a run reads a controller's, and compares. Comes back at the latest a second
/// after the train has ended. @throws GpioError likewise.
LoopBackStep measureLoopBack(const std::shared_ptr<GpioSystem>& system, const LoopBackLines& lines,
                             EdgeTrain& train, const TrainPlan& plan);

}  // namespace kerfbench::source
