// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/loopback.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "hil/base/terminal.h"
#include "hil/doctor/doctor.h"
#include "hil/doctor/virtual_machine.h"
#include "hil/source/gpio/output_lines.h"
#include "hil/source/gpio/real_time.h"

namespace kerfbench::doctor {
namespace {

const source::GpioChipInfo& chipOf(const std::string& which, const source::GpioChipList& chips) {
  if (!which.empty()) return source::findChip(chips, which);
  if (chips.chips.size() == 1) return chips.chips.front();
  if (chips.chips.empty()) {
    throw source::GpioError(fmt::format("this computer has no gpiochip that can be read{}{}",
                                        chips.faults.empty() ? "" : "\n", fmt::join(chips.faults, "\n")));
  }
  throw source::GpioError(
      fmt::format("there are {} gpiochips: say by --chip which one has the input", chips.chips.size()));
}

source::ChipLine chipLineOf(const source::GpioLineInfo& line, const char* role) {
  return {line.offset, line.name.empty() ? role : line.name};
}

/// The first input that nobody uses.
const source::GpioLineInfo& freeInput(const source::GpioChipInfo& chip, const source::LoopBackLines& lines) {
  const auto fits = [&](const source::GpioLineInfo& line) {
    const bool is_out = lines.out_chip == chip.path && line.offset == lines.out.offset;
    return !line.used && !line.output && line.offset != lines.in.offset && !is_out;
  };
  const auto found = std::ranges::find_if(chip.lines, fits);
  if (found == chip.lines.end()) {
    throw source::GpioError(
        fmt::format("{} has no further free input to be read besides, as the lines of a run are: "
                    "the kernel numbers edges well in a request of several lines only",
                    chip.path.string()));
  }
  return *found;
}

/// An even number, so that the line ends low; at least one pulse.
std::uint64_t edgesOf(double rate_hz, double seconds) {
  return 2 * std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(rate_hz * seconds / 2.0)));
}

}  // namespace

source::LoopBackLines chosenLines(const LoopbackOptions& options, const source::GpioChipList& chips) {
  const auto equals = options.loop_back.find('=');
  if (equals == std::string::npos)
    throw source::GpioError(fmt::format("--loop-back is to be OUT=IN, and is '{}'", options.loop_back));
  const source::GpioChipInfo& in_chip = chipOf(options.chip, chips);
  const source::GpioChipInfo& out_chip =
      options.out_chip.empty() ? in_chip : source::findChip(chips, options.out_chip);
  std::string faults;
  const auto find = [&](const source::GpioChipInfo& chip, const std::string& which, const char* role) {
    try {
      return chipLineOf(source::findLine(chip, which), role);
    } catch (const source::GpioError& e) {
      faults += fmt::format("{}{}: {}", faults.empty() ? "" : "\n", role, e.what());
      return source::ChipLine{};
    }
  };
  source::LoopBackLines lines{out_chip.path,
                              find(out_chip, options.loop_back.substr(0, equals), "OUT"),
                              in_chip.path,
                              find(in_chip, options.loop_back.substr(equals + 1), "IN"),
                              {}};
  if (!options.beside.empty()) lines.beside = find(in_chip, options.beside, "beside");
  if (!faults.empty()) throw source::GpioError(faults);
  if (options.beside.empty()) lines.beside = chipLineOf(freeInput(in_chip, lines), "beside");
  const bool one_chip = lines.out_chip == lines.in_chip;
  if (lines.in.offset == lines.beside.offset ||
      (one_chip && (lines.out.offset == lines.in.offset || lines.out.offset == lines.beside.offset)))
    throw source::GpioError("OUT, IN and the line that is read besides are to be three lines");
  return lines;
}

void measureRates(const std::shared_ptr<source::GpioSystem>& system, source::EdgeTrain& train,
                  const LoopbackOptions& options, BenchReport& report) {
  const source::RealTime real_time(system);
  report.real_time_notes = real_time.notes();
  if (const std::string trouble = source::wireTrouble(system, report.lines, train); !trouble.empty())
    throw source::GpioError(trouble);
  std::vector<double> rates_hz = options.rates_hz;
  std::ranges::sort(rates_hz);
  for (const double rate_hz : rates_hz) {
    const auto period_ns = static_cast<std::uint64_t>(std::llround(1e9 / rate_hz));
    report.steps.push_back(
        source::measureLoopBack(system, report.lines, train, {edgesOf(rate_hz, options.seconds), period_ns}));
    if (!report.steps.back().held() || !report.steps.back().wasDriven()) return;
  }
}

const source::LoopBackStep* sustained(const BenchReport& report) {
  const source::LoopBackStep* best = nullptr;
  for (const source::LoopBackStep& step : report.steps) {
    if (step.held() && (best == nullptr || step.driven_hz > best->driven_hz)) best = &step;
  }
  return best;
}

std::optional<StampBound> stampBound(const BenchReport& report) {
  StampBound bound;
  std::uint64_t worst_ns = 0;
  for (const source::LoopBackStep& step : report.steps) {
    if (!step.held()) continue;
    bound.edges += step.read;
    worst_ns = std::max(worst_ns, step.stamp_most.worst_ns);
  }
  if (bound.edges == 0) return std::nullopt;
  bound.stamp_err_us = static_cast<std::uint32_t>(worst_ns / 1000 + 1);
  return bound;
}

int measureLoopback(const LoopbackOptions& options, bool json) {
  BenchReport report;
  try {
    const std::shared_ptr<source::GpioSystem> system = source::linuxGpioSystem();
    report.lines = chosenLines(options, source::listChips());
    report.kernel = kernelName();
    report.clock_source = clockSource();
    report.virtual_machine = virtualMachineSign();
    source::ThreadTrain train(
        system, source::OutputLines(system, report.lines.out_chip, {report.lines.out}, {false}));
    measureRates(system, train, options, report);
  } catch (const source::GpioError& e) {
    base::toTerminal(stderr, fmt::format("{}\n", e.what()));
    return 1;
  }
  if (json)
    base::toTerminalAsItIs(stdout, base::jsonForTerminal(benchJson(report)));
  else
    base::toTerminal(stdout, benchText(report));
  return sustained(report) != nullptr ? 0 : 1;
}

}  // namespace kerfbench::doctor
