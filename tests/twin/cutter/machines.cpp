// SPDX-License-Identifier: Apache-2.0
#include "tests/twin/cutter/machines.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

namespace kerfbench::twin {
namespace {

ServoDescription servo(double bandwidth_hz, double damping, double feedforward) {
  ServoDescription result;
  result.natural_frequency_rad_s = 2.0 * std::numbers::pi * bandwidth_hz;
  result.damping = damping;
  result.velocity_feedforward = feedforward;
  return result;
}

// Sets stiffness and damping between motor and load by their resonance against each other, both free.
void couple(AxisDescription& axis, double load_per_motor_si, double resonance_hz, double damping) {
  const double w = 2.0 * std::numbers::pi * resonance_hz;
  // Inertia referred to the load.
  const double motor = axis.motor_inertia_kg_m2 / (load_per_motor_si * load_per_motor_si);
  const double reduced = motor * axis.load_inertia / (motor + axis.load_inertia);
  axis.stiffness = reduced * w * w;
  axis.stiffness_damping = 2.0 * damping * reduced * w;
}

AxisDescription galvo(const ServoDescription& drive) {
  constexpr double kUs = 1e-6;
  AxisDescription result;
  result.profile = {"galvo-pul-dir", true, 5 * kUs, 2.5 * kUs, 2.5 * kUs, 2.5 * kUs};
  result.drive = drive;
  result.step = kGalvoStepRad;
  result.motor_inertia_kg_m2 = 3e-7;
  result.load_inertia = 2e-7;
  couple(result, 1.0, 6000.0, 0.02);
  return result;
}

// A slide with a belt over a pulley of 40 mm a turn.
AxisDescription slide(const ServoDescription& drive, double mass_kg) {
  constexpr double kUs = 1e-6;
  AxisDescription result;
  result.profile = {"DM556", true, 5 * kUs, 10 * kUs, 2.5 * kUs, 2.5 * kUs};
  result.drive = drive;
  result.step = kTravelStepMm;
  result.load_per_motor = 40.0 / (2.0 * std::numbers::pi);
  result.motor_inertia_kg_m2 = 1e-4;
  result.load_inertia = mass_kg;
  couple(result, 1e-3 * result.load_per_motor, 400.0, 0.05);
  return result;
}

// A feed with a gear of one to four on the roller.
AxisDescription feedOf(const ServoDescription& drive, double roller_inertia_kg_m2) {
  AxisDescription result = slide(drive, roller_inertia_kg_m2);
  result.load_per_motor = 0.25;
  couple(result, result.load_per_motor, 400.0, 0.05);
  return result;
}

MachineDescription common() {
  MachineDescription machine;
  machine.kerf_camera.fx_px = machine.kerf_camera.fy_px = 1e4;
  constexpr std::array kPortA{Signal::kGalvoXPul,  Signal::kGalvoXDir,  Signal::kGalvoYPul,
                              Signal::kGalvoYDir,  Signal::kGantryXPul, Signal::kGantryXDir,
                              Signal::kGantryYPul, Signal::kGantryYDir};
  constexpr std::array kPortC{Signal::kFeedPul, Signal::kFeedDir, Signal::kLaserGate, Signal::kLaserPwm};
  for (std::uint16_t bit = 0; bit < kPortA.size(); ++bit) machine.signals.assign(kPortA.at(bit), {0, bit});
  for (std::uint16_t bit = 0; bit < kPortC.size(); ++bit) machine.signals.assign(kPortC.at(bit), {2, bit});
  machine.belt.line_servo = servo(20, 1.0, 1.0);
  machine.belt.feed = feedOf(servo(40, 1.0, 1.0), machine.belt.roller_inertia_kg_m2);
  machine.belt.print_mark_sensor.x_mm = -150.0;
  machine.laser.full_power_w = 100.0;
  machine.laser.rise_time_s = 20e-6;
  return machine;
}

}  // namespace

MachineDescription twoMirror() {
  MachineDescription machine = common();
  machine.kind = MachineDescription::Kind::kTwoMirror;
  machine.head.throw_mm = 500.0;
  machine.head.mirror_spacing_mm = 15.0;
  machine.galvo_x = machine.galvo_y = galvo(servo(1200, 0.7, 0.0));
  return machine;
}

MachineDescription gantry() {
  MachineDescription machine = common();
  machine.kind = MachineDescription::Kind::kGantry;
  machine.gantry_x = slide(servo(80, 0.9, 1.0), 12.0);
  machine.gantry_y = slide(servo(80, 0.9, 1.0), 3.0);
  machine.travel_min_mm = {-2.0, -3.0};
  machine.travel_max_mm = {2.0, 3.0};
  return machine;
}

WebDescription lineWeb() {
  WebDescription web;
  web.print.units = 3;
  web.print.pitch_mm = 50.0;
  web.print.eye_mark_x_mm = 4.0;
  web.print.eye_mark_length_mm = 4.0;
  web.start_x_mm = -157.0;
  web.belt_speed_mm_s = 60.0;
  return web;
}

WebDescription fedWeb() {
  WebDescription web = lineWeb();
  web.fed_by_controller = true;
  return web;
}

double Pins::steps(Signal pul, double from_s, int count, double period_s, bool forward) {
  const auto dir = static_cast<Signal>(static_cast<std::size_t>(pul) + 1);
  set(from_s - 50e-6, dir, forward);
  for (int i = 0; i < count; ++i) {
    set(from_s + i * period_s, pul, true);
    set(from_s + i * period_s + 5e-6, pul, false);
  }
  return from_s + count * period_s;
}

std::vector<PinEvent> Pins::events() const {
  std::vector<Write> writes = writes_;
  std::ranges::stable_sort(writes, {}, &Write::tick);
  std::map<std::uint16_t, std::uint16_t> levels;
  std::vector<PinEvent> events;
  for (const Write& write : writes) {
    const PinId pin = map_.pin(write.signal).value();
    const auto mask = static_cast<std::uint16_t>(1U << pin.bit);
    auto& level = levels[pin.port];
    const auto before = level;
    level = static_cast<std::uint16_t>(write.level ? level | mask : level & ~mask);
    if (level == before) continue;
    events.push_back({write.tick, pin.port, static_cast<std::uint16_t>(level ^ before), level, 0});
  }
  return events;
}

void run(Twin& twin, const std::vector<PinEvent>& events, Tick from, Tick end, Tick quantum,
         const QuantumFn& each) {
  auto next = std::ranges::upper_bound(events, from, {}, &PinEvent::tick);
  for (Tick now = from; now < end;) {
    const Tick until = std::min(now + quantum, end);
    const auto edges = each ? twin.predictSensors(until) : std::vector<SensorEdge>{};
    const auto last = std::ranges::upper_bound(events, until, {}, &PinEvent::tick);
    twin.advance(until, std::span(next, last));
    next = last;
    if (each) each(now, until, edges);
    now = until;
  }
}

void QuadratureCounter::apply(const SensorEdge& edge) {
  if (edge.signal == Signal::kEncoderA) {
    if (edge.level == a_) ++illegal_;
    a_ = edge.level;
    count_ += a_ != b_ ? 1 : -1;
  } else if (edge.signal == Signal::kEncoderB) {
    if (edge.level == b_) ++illegal_;
    b_ = edge.level;
    count_ += a_ == b_ ? 1 : -1;
  }
}

}  // namespace kerfbench::twin
