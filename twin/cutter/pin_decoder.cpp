// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/pin_decoder.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

namespace kerfbench::twin {
namespace {

struct AxisSignals {
  Axis axis;
  Signal pul, dir;
};
constexpr std::array<AxisSignals, kAxisCount> kAxes{{
    {Axis::kGalvoX, Signal::kGalvoXPul, Signal::kGalvoXDir},
    {Axis::kGalvoY, Signal::kGalvoYPul, Signal::kGalvoYDir},
    {Axis::kGantryX, Signal::kGantryXPul, Signal::kGantryXDir},
    {Axis::kGantryY, Signal::kGantryYPul, Signal::kGantryYDir},
    {Axis::kFeed, Signal::kFeedPul, Signal::kFeedDir},
}};

bool isFitted(const MachineDescription& machine, const WebDescription& web, Axis axis) {
  if (axis == Axis::kFeed) return web.fed_by_controller;
  const bool of_gantry = axis == Axis::kGantryX || axis == Axis::kGantryY;
  return of_gantry == (machine.kind == MachineDescription::Kind::kGantry);
}

}  // namespace

PinDecoder::Wire PinDecoder::wire(const SignalMap& map, Signal signal) {
  const auto pin = map.pin(signal);
  return pin ? Wire{pin->port, static_cast<std::uint16_t>(1U << pin->bit)} : Wire{};
}

PinDecoder::PinDecoder(const MachineDescription& machine, const WebDescription& web, TickRate rate)
    : rate_(rate),
      gate_input_{wire(machine.signals, Signal::kLaserGate), machine.laser.gate_low},
      pwm_input_{wire(machine.signals, Signal::kLaserPwm), machine.laser.pwm_low} {
  if (pwm_input_.wire.mask == 0) pwm_.set(-std::numeric_limits<double>::max(), true);
  for (const auto& [axis, pul, dir] : kAxes) {
    const bool wired = machine.signals.pin(pul) && machine.signals.pin(dir);
    if (!wired || !isFitted(machine, web, axis)) continue;
    const Wire enable = wire(machine.signals, enableOf(pul));
    inputs_.push_back({axis, wire(machine.signals, pul), wire(machine.signals, dir), enable,
                       PulseDecoder(axisOf(machine, axis).profile, enable.mask != 0)});
  }
  std::uint16_t last_port = 0;
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    last_port = std::max(last_port, wire(machine.signals, static_cast<Signal>(i)).port);
  }
  ports_.assign(static_cast<std::size_t>(last_port) + 1, 0);
}

void PinDecoder::decode(const PinEvent& event, MachineModel& model) {
  if (event.port >= ports_.size()) return;  // The port has none of the machine's signals.
  const auto changed = static_cast<std::uint16_t>(ports_[event.port] ^ event.level);
  if (changed == 0) return;
  ports_[event.port] = event.level;
  const double time_s = rate_.seconds(event.tick);
  const auto moved = [&](Wire wire) { return wire.port == event.port && (wire.mask & changed) != 0; };
  for (Input& input : inputs_) {
    const bool enable_moved = moved(input.enable);
    if (!enable_moved && !moved(input.pul) && !moved(input.dir)) continue;
    std::vector<StepEdge>& steps = model.command(input.axis).incoming();
    if (enable_moved) input.decoder.enableLevel(time_s, high(input.enable), steps);
    input.decoder.levels(time_s, high(input.pul), high(input.dir), steps);
  }
  if (moved(pwm_input_.wire)) pwm_.set(time_s, high(pwm_input_.wire) != pwm_input_.is_low);
  if (!moved(gate_input_.wire)) return;
  const bool open = high(gate_input_.wire) != gate_input_.is_low;
  if (open != std::exchange(gate_open_, open)) gate_edges_.push(time_s);
}

void PinDecoder::settle(Tick now, MachineModel& model) {
  const double now_s = rate_.seconds(now);
  for (Input& input : inputs_) input.decoder.settle(now_s, model.command(input.axis).incoming());
}

}  // namespace kerfbench::twin
