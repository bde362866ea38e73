// SPDX-License-Identifier: Apache-2.0
#include "hil/run/provoke.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerfbench::run {

namespace {

using Cause = scenario::ProvokeChoice::Cause;

constexpr int kFlickers = 20;

bool isLost(const scenario::ProvokeChoice& choice, Signal signal) {
  return (signal == Signal::kEncoderA && choice.encoder_lines != "b") ||
         (signal == Signal::kEncoderB && choice.encoder_lines != "a");
}

}  // namespace

Provocation::Provocation(const scenario::ProvokeChoice& choice, TickRate rate, std::uint64_t seed)
    : choice_(choice),
      at_(rate.ticksAt(choice.at_s)),
      flicker_(rate.ticksAt(scenario::kFlicker_s)),
      closed_again_(rate.ticksAt(choice.at_s + choice.open_for_s)),
      random_(static_cast<std::mt19937::result_type>(seed)),
      line_cut_s_(std::numeric_limits<double>::quiet_NaN()) {}

void Provocation::changeSensors(std::vector<SensorEdge>& edges, Tick from, Tick until) const {
  const auto add = [&](Tick tick, Signal signal, bool level) {
    if (tick > from && tick <= until) edges.push_back({tick, signal, level});
  };
  if (choice_.cause == Cause::kInterlock) {
    add(at_, Signal::kInterlock, false);
    add(closed_again_, Signal::kInterlock, true);
  } else if (choice_.cause == Cause::kLimit) {
    const Signal signal = choice_.limit == "x" ? Signal::kLimitX : Signal::kLimitY;
    std::erase_if(edges, [&](const SensorEdge& edge) { return edge.signal == signal && edge.tick >= at_; });
    add(at_, signal, true);
  } else if (choice_.cause == Cause::kMarksFlicker) {
    for (int i = 0; i < kFlickers; ++i) {
      add(at_ + static_cast<Tick>(i) * flicker_, Signal::kPrintMark, true);
      add(at_ + static_cast<Tick>(i) * flicker_ + flicker_ / 2, Signal::kPrintMark, false);
    }
  } else if (choice_.cause == Cause::kEncoder) {
    std::erase_if(edges,
                  [&](const SensorEdge& edge) { return edge.tick >= at_ && isLost(choice_, edge.signal); });
  }
  std::ranges::stable_sort(edges, {}, &SensorEdge::tick);
}

std::vector<std::uint8_t> Provocation::toController(std::vector<std::uint8_t> bytes, double now_s) {
  if (now_s < choice_.at_s || bytes.empty()) return bytes;
  if (choice_.cause == Cause::kUartSilent) {
    if (!std::isnan(line_cut_s_)) return {};
    line_cut_s_ = now_s;
    bytes.resize(bytes.size() / 2);
  } else if (choice_.cause == Cause::kUartNoise) {
    if (std::isnan(line_cut_s_)) line_cut_s_ = now_s;
    for (std::uint8_t& byte : bytes) {
      if (static_cast<double>(random_()) < choice_.share * 4294967296.0)
        byte = static_cast<std::uint8_t>(byte ^ (1U << (random_() & 7U)));
    }
  }
  return bytes;
}

}  // namespace kerfbench::run
