// SPDX-License-Identifier: Apache-2.0
#include "hil/run/live_model.h"

#include <algorithm>

#include "twin/cutter/twin.h"

namespace kerfbench::run {
namespace {

twin::TwinOptions sensorsOnly(std::uint64_t seed) {
  return {.fidelity = twin::Fidelity::kFast, .seed = seed, .record_exposures = false};
}

bool isLimit(const SensorEdge& edge) {
  return edge.signal == Signal::kLimitX || edge.signal == Signal::kLimitY;
}

}  // namespace

LiveModel::LiveModel(const twin::MachineDescription& machine, const twin::WebDescription& web, TickRate rate,
                     std::uint64_t seed, bool with_limits)
    : rate_(rate), ahead_(std::make_unique<twin::Twin>(machine, web, rate, sensorsOnly(seed))) {
  if (with_limits) behind_ = std::make_unique<twin::Twin>(machine, web, rate, sensorsOnly(seed));
  for (const SensorEdge& edge : ahead_->predictSensors(ahead_to_)) {
    if (edge.level) high_at_start_.push_back(edge.signal);
  }
  ahead_->advance(ahead_to_, {});
}

LiveModel::~LiveModel() = default;

std::vector<SensorEdge> LiveModel::predictSensors(Tick until) {
  std::vector<SensorEdge> all;
  const Tick goal = until + rate_.ticksAt(kAhead_s);
  while (ahead_to_ < goal) {
    const Tick next = std::min(goal, ahead_to_ + rate_.ticksAt(kStep_s));
    std::vector<SensorEdge> edges = ahead_->predictSensors(next);
    std::erase_if(edges, isLimit);
    all.insert(all.end(), edges.begin(), edges.end());
    ahead_->advance(next, {});
    ahead_to_ = next;
  }
  if (behind_) {
    std::vector<SensorEdge> edges = behind_->predictSensors(until);
    std::erase_if(edges, [](const SensorEdge& edge) { return !isLimit(edge); });
    all.insert(all.end(), edges.begin(), edges.end());
  }
  return all;
}

void LiveModel::advance(Tick until, std::span<const PinEvent> events) {
  if (behind_) behind_->advance(until, events);
}

}  // namespace kerfbench::run
