// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/child_check.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "hil/source/open.h"

namespace kerfbench::doctor {
namespace {

constexpr double kQuantum_s = 0.5e-3;
constexpr double kOtherQuantum_s = 0.17e-3;

/// What came of a run.
struct Trial {
  std::vector<PinEvent> events;
  std::vector<std::uint8_t> uart;
  Tick reached{};
  source::Stop stop{source::Stop::kReached};
  std::string message;
};

std::unique_ptr<source::SignalSource> opened(const ChildOptions& options,
                                             const std::filesystem::path& image) {
  source::ChildSourceOptions child;
  child.child = options.child;
  child.image = image;
  child.mcu = options.mcu;
  child.clock_hz = options.clock_hz;
  child.baud = options.baud;
  return source::openChild(child);
}

Trial run(const ChildOptions& options, double quantum_s, bool is_foreseen = false) {
  const auto source = opened(options, options.image);
  const TickRate rate = source->info().rate;
  const Tick end = rate.ticksAt(options.seconds);
  const Tick quantum = std::max<Tick>(1, rate.ticksAt(quantum_s));
  if (is_foreseen) source->foresee(quantum, end);
  Trial trial;
  source::Batch batch;
  while (trial.stop == source::Stop::kReached && trial.reached < end) {
    trial.stop = source->advance(std::min(end, trial.reached + quantum), batch);
    trial.reached = batch.watermark;
    trial.events.insert(trial.events.end(), batch.events.begin(), batch.events.end());
    trial.uart.insert(trial.uart.end(), batch.uart.begin(), batch.uart.end());
  }
  trial.message = source->message();
  return trial;
}

std::string described(const PinEvent& event) {
  return fmt::format("tick {}, port {}, level {:#06x}", event.tick, event.port, event.level);
}

/// Where two runs part, in words; empty: nowhere.
std::string difference(const Trial& one, const Trial& two) {
  const auto [first, second] = std::ranges::mismatch(one.events, two.events);
  const auto number = first - one.events.begin() + 1;
  if (first != one.events.end() && second != two.events.end())
    return fmt::format("event {} is once {}, once {}", number, described(*first), described(*second));
  if (first != one.events.end() || second != two.events.end())
    return fmt::format("{} events once, {} once", one.events.size(), two.events.size());
  if (one.uart != two.uart) return "the UART says something else";
  return {};
}

DoctorFinding finding(bool good, std::string text) {
  return {good ? DoctorFinding::Grade::kGood : DoctorFinding::Grade::kTrouble, std::move(text)};
}

DoctorFinding starting(const ChildOptions& options) {
  const source::SourceInfo info = opened(options, options.image)->info();
  return finding(true, fmt::format("it starts: a tick is {}/{} s, stamps are right to {} ticks; {}",
                                   info.rate.num, info.rate.den, info.stamp_err_ticks, info.config_id));
}

DoctorFinding running(const ChildOptions& options, const Trial& trial) {
  if (trial.stop == source::Stop::kReached)
    return finding(true,
                   fmt::format("it runs {} s: {} events in order, {} bytes on the UART{}", options.seconds,
                               trial.events.size(), trial.uart.size(),
                               trial.events.empty() ? " (an image that does nothing shows little)" : ""));
  return finding(false, fmt::format("it stops at tick {}: {}", trial.reached, trial.message));
}

DoctorFinding same(const std::string& difference, const std::string& what) {
  return difference.empty() ? finding(true, what + ": the same")
                            : finding(false, fmt::format("{}: {}", what, difference));
}

DoctorFinding refusing(const ChildOptions& options) {
  const std::filesystem::path nothing = options.image.string() + ".is-not-there";
  try {
    (void)opened(options, nothing);
  } catch (const std::system_error&) {
    return finding(false, "an image that is not there is taken: it must be refused by ERROR");
  } catch (const std::runtime_error& fault) {
    const std::string words = fault.what();
    const bool by_error = !words.starts_with(options.child.string() + ": ");
    return finding(by_error, by_error ? "an image that is not there is refused: " + words
                                      : "an image that is not there ends it without ERROR: " + words);
  }
  return finding(false, "an image that is not there is taken: it must be refused by ERROR");
}

}  // namespace

std::vector<DoctorFinding> checkChild(const ChildOptions& options) {
  std::vector<DoctorFinding> findings;
  try {
    findings.push_back(starting(options));
    const Trial once = run(options, kQuantum_s);
    findings.push_back(running(options, once));
    findings.push_back(same(difference(once, run(options, kQuantum_s)), "a second run"));
    findings.push_back(
        same(difference(once, run(options, kOtherQuantum_s)),
             fmt::format("a run in quanta of {} ms instead of {}", 1e3 * kOtherQuantum_s, 1e3 * kQuantum_s)));
    findings.push_back(same(difference(once, run(options, kQuantum_s, true)),
                            "a run that asks for quanta before the answers to others are read"));
    findings.push_back(refusing(options));
  } catch (const std::runtime_error& fault) {
    findings.push_back(finding(false, fault.what()));
  }
  return findings;
}

}  // namespace kerfbench::doctor
