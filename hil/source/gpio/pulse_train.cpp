// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/pulse_train.h"

#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "hil/source/gpio/real_time.h"

namespace kerfbench::source {
namespace {

constexpr std::uint64_t kTrainPatience_ns = 100'000'000;

void waitUntil(GpioSystem& system, std::uint64_t due_ns) {
  for (std::uint64_t now_ns = system.now_ns(); now_ns < due_ns; now_ns = system.now_ns()) {
    short none = 0;
    system.poll(-1, due_ns - now_ns, none);
  }
}

}  // namespace

double DrivenTrain::rate_hz() const {
  if (edges.size() < 2) return 0.0;
  return 1e9 * static_cast<double>(edges.size() - 1) /
         static_cast<double>(edges.back().before_ns - edges.front().before_ns);
}

DrivenTrain playTrain(GpioSystem& system, OutputLines& line, const TrainPlan& plan) {
  DrivenTrain driven;
  driven.edges.reserve(plan.edges);  // Memory that grows would be late edges.
  const std::uint64_t begin_ns = system.now_ns();
  const std::uint64_t last_ns = begin_ns + plan.edges * plan.period_ns;
  const std::uint64_t give_up_ns = last_ns + (last_ns - begin_ns) / 4 + kTrainPatience_ns;
  std::uint64_t earliest_ns = begin_ns;
  for (std::uint64_t i = 0; i < plan.edges; ++i) {
    const bool level = i % 2 == 0;
    const std::uint64_t planned_ns = begin_ns + (i + 1) * plan.period_ns;
    waitUntil(system, std::max(planned_ns, earliest_ns));
    const std::uint64_t before_ns = system.now_ns();
    if (level && before_ns > give_up_ns) break;
    line.set({{0, level}});
    const std::uint64_t after_ns = system.now_ns();
    driven.edges.push_back({before_ns, after_ns});
    driven.lag.add(static_cast<std::int64_t>(after_ns - planned_ns), after_ns);
    earliest_ns = before_ns + plan.period_ns / 2;
  }
  return driven;
}

ThreadTrain::ThreadTrain(std::shared_ptr<GpioSystem> system, OutputLines line)
    : system_(std::move(system)), line_(std::move(line)) {}

void ThreadTrain::begin(const TrainPlan& plan) {
  train_ = std::async(std::launch::async, [this, plan] {
    // Where real time is not allowed, RealTime says so for the reader, and a timer is to be exact at least.
    (void)system_->setRealTime(RealTime::kPriority - 1);
    ::prctl(PR_SET_TIMERSLACK, 1UL);
    return playTrain(*system_, line_, plan);
  });
}

bool ThreadTrain::done() const {
  return train_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace kerfbench::source
