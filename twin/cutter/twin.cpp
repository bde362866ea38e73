// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/twin.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kerfbench::twin {
namespace {

struct AxisSignals {
  Axis axis;
  const char* name;
  Signal pul, dir;
};
constexpr std::array<AxisSignals, kAxisCount> kAxes{{
    {Axis::kGalvoX, "galvo_x", Signal::kGalvoXPul, Signal::kGalvoXDir},
    {Axis::kGalvoY, "galvo_y", Signal::kGalvoYPul, Signal::kGalvoYDir},
    {Axis::kGantryX, "gantry_x", Signal::kGantryXPul, Signal::kGantryXDir},
    {Axis::kGantryY, "gantry_y", Signal::kGantryYPul, Signal::kGantryYDir},
    {Axis::kFeed, "feed", Signal::kFeedPul, Signal::kFeedDir},
}};

const AxisDescription* fittedAxis(const MachineDescription& machine, const WebDescription& web, Axis axis) {
  const bool gantry = machine.kind == MachineDescription::Kind::kGantry;
  switch (axis) {
    case Axis::kGalvoX:
      return gantry ? nullptr : &machine.galvo_x;
    case Axis::kGalvoY:
      return gantry ? nullptr : &machine.galvo_y;
    case Axis::kGantryX:
      return gantry ? &machine.gantry_x : nullptr;
    case Axis::kGantryY:
      return gantry ? &machine.gantry_y : nullptr;
    case Axis::kFeed:
      return web.fed_by_controller ? &machine.belt.feed : nullptr;
    case Axis::kCount:
      break;
  }
  return nullptr;
}

const MachineDescription& checked(const MachineDescription& machine, const WebDescription& web) {
  std::string faults;
  const auto require = [&faults](bool fine, const std::string& rule) {
    if (!fine) faults += (faults.empty() ? "machine: " : "; ") + rule;
  };
  for (const AxisSignals& axis : kAxes) {
    const AxisDescription* fitted = fittedAxis(machine, web, axis.axis);
    require(fitted == nullptr ||
                (fitted->step > 0 && fitted->inertia > 0 && fitted->servo.natural_frequency_rad_s > 0),
            std::string(axis.name) + " needs a step, an inertia and a bandwidth > 0");
  }
  // Joint x moves bridge and carriage, joint y the carriage alone.
  require(machine.kind != MachineDescription::Kind::kGantry ||
              machine.gantry_x.inertia > machine.gantry_y.inertia,
          "gantry_x must move more mass than gantry_y");
  require(machine.belt.roller_radius_mm > 0 && machine.belt.roller_inertia_kg_m2 > 0 &&
              machine.belt.encoder_count_mm > 0,
          "the belt needs a roller and an encoder count > 0");
  const CameraDescription& camera = machine.spot_camera;
  require(camera.exposure_s >= 0.999 * MachineModel::kStep_s && camera.exposure_s <= camera.frame_period_s,
          "the spot camera's exposure must be at least a step and no longer than its frame period");
  if (!faults.empty()) throw std::invalid_argument(faults);
  return machine;
}

double firstMarkTravel_mm(const MachineDescription& machine, const WebDescription& web) {
  return machine.belt.print_mark_sensor_x_mm - (web.start_x_mm + web.print.eye_mark_x_mm);
}

}  // namespace

Twin::Twin(const MachineDescription& machine, const WebDescription& web, TickRate rate)
    : machine_(checked(machine, web)),
      web_(web),
      rate_(rate),
      model_(machine, web),
      sensors_(rate, machine.belt.encoder_count_mm, web.print, firstMarkTravel_mm(machine, web)),
      laser_(machine.laser),
      sheet_(web.board) {
  std::uint16_t last_port = 0;
  for (const AxisSignals& axis : kAxes) {
    const AxisDescription* fitted = fittedAxis(machine_, web_, axis.axis);
    const auto pul = machine_.signals.pin(axis.pul);
    const auto dir = machine_.signals.pin(axis.dir);
    if (fitted == nullptr || !pul || !dir) continue;
    inputs_.push_back({axis.axis, *pul, *dir, PulseDecoder(axis.name, fitted->profile)});
  }
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto pin = machine_.signals.pin(static_cast<Signal>(i));
    if (pin) last_port = std::max(last_port, pin->port);
  }
  ports_.assign(static_cast<std::size_t>(last_port) + 1, 0);
}

std::vector<SensorEdge> Twin::predictSensors(Tick until) {
  std::vector<SensorEdge> edges;
  if (!sensors_started_) {
    sensors_started_ = true;
    edges.push_back({now_ + 1, Signal::kInterlock, true});
  }
  const Eigen::Vector2d gantry = model_.gantry_mm();
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const bool tripped =
        machine_.kind == MachineDescription::Kind::kGantry &&
        (gantry[axis] < machine_.travel_min_mm.at(i) || gantry[axis] > machine_.travel_max_mm.at(i));
    if (tripped != limits_.at(i)) {
      limits_.at(i) = tripped;
      edges.push_back({now_ + 1, i == 0 ? Signal::kLimitX : Signal::kLimitY, tripped});
    }
  }
  // The machine's state is that of its last whole step, a fraction of a step before now.
  const double behind_s = now_s() - static_cast<double>(steps_) * MachineModel::kStep_s;
  const BeltForecast forecast{now_, model_.beltTravel_mm() + model_.beltSpeed_mm_s() * behind_s,
                              model_.beltSpeed_mm_s(), model_.beltAcceleration_mm_s2()};
  const auto belt = sensors_.edges(forecast, until);
  edges.insert(edges.end(), belt.begin(), belt.end());
  std::ranges::stable_sort(edges, {}, &SensorEdge::tick);
  return edges;
}

bool Twin::pinLevel(PinId pin) const {
  return pin.port < ports_.size() && ((static_cast<unsigned>(ports_[pin.port]) >> pin.bit) & 1U) != 0;
}

void Twin::decode(const PinEvent& event) {
  if (event.port >= ports_.size()) return;  // A port without any of the machine's signals.
  ports_[event.port] = event.level;
  const double time_s = rate_.seconds(event.tick);
  for (Input& input : inputs_) {
    if (input.pul.port != event.port && input.dir.port != event.port) continue;
    input.decoder.levels(time_s, pinLevel(input.pul), pinLevel(input.dir),
                         model_.command(input.axis).incoming());
  }
  const auto gate = machine_.signals.pin(Signal::kLaserGate);
  const auto pwm = machine_.signals.pin(Signal::kLaserPwm);
  const bool open = gate && pinLevel(*gate);
  gate_.set(time_s, open);
  beam_.set(time_s, open && (!pwm || pinLevel(*pwm)));
}

void Twin::advance(Tick until, std::span<const PinEvent> events) {
  for (const PinEvent& event : events) decode(event);
  now_ = until;
  for (Input& input : inputs_) input.decoder.settle(now_s(), model_.command(input.axis).incoming());
  // Only whole steps: what is left over belongs to the next quantum, so that quanta leave no trace.
  while (static_cast<double>(steps_ + 1) * MachineModel::kStep_s <= now_s() + 1e-12) stepMachine();
}

void Twin::stepMachine() {
  const double begin_s = static_cast<double>(steps_) * MachineModel::kStep_s;
  const double web_before_mm = web_.start_x_mm + model_.beltTravel_mm();
  const auto spot_before = model_.spot();
  model_.step(begin_s);
  const double heard_s = begin_s - machine_.laser.gate_delay_s;
  const double energy_j =
      laser_.step(beam_.meanOver(heard_s, heard_s + MachineModel::kStep_s), MachineModel::kStep_s);
  emitted_j_ += energy_j;
  ++steps_;
  const double web_mm = web_.start_x_mm + model_.beltTravel_mm();
  const auto spot = model_.spot();
  if (energy_j > 0 && spot && spot_before) {
    const auto footprint = [&](const BeamSpot& s, double web_x_mm) {
      return Footprint{{s.p_WQ_mm.x() - web_x_mm, s.p_WQ_mm.y()},
                       machine_.spot_radius_mm * s.stretch_x,
                       machine_.spot_radius_mm * s.stretch_y};
    };
    sheet_.burn(footprint(*spot_before, web_before_mm), footprint(*spot, web_mm), energy_j);
  }
  const Eigen::Vector2d mean_spot = spot && spot_before
                                        ? Eigen::Vector2d(0.5 * (spot->p_WQ_mm + spot_before->p_WQ_mm))
                                        : Eigen::Vector2d::Zero();
  expose(mean_spot, machine_.spot_radius_mm, spot && spot_before ? energy_j : 0.0,
         0.5 * (web_before_mm + web_mm));
}

void Twin::expose(const Eigen::Vector2d& p_WQ_mm, double radius_mm, double energy_j, double web_x_mm) {
  const CameraDescription& camera = machine_.spot_camera;
  const auto period = static_cast<std::uint64_t>(std::llround(camera.frame_period_s / MachineModel::kStep_s));
  const auto length = static_cast<std::uint64_t>(std::llround(camera.exposure_s / MachineModel::kStep_s));
  const std::uint64_t index = (steps_ - 1) % period;
  if (index >= length) return;
  if (index == 0) {
    exposure_.sequence = frame_++;
    exposure_.start_s = static_cast<double>(steps_ - 1) * MachineModel::kStep_s;
    exposure_.samples.clear();
  }
  exposure_.samples.push_back({p_WQ_mm, radius_mm, energy_j / MachineModel::kStep_s, {web_x_mm, 0.0}, 0.0});
  if (index + 1 == length) exposures_.push_back(exposure_);
}

std::vector<PulseTiming> Twin::pulseTiming() const {
  std::vector<PulseTiming> timing;
  for (const Input& input : inputs_) timing.push_back(input.decoder.timing());
  return timing;
}

std::vector<std::pair<double, double>> Twin::gateIntervals() const { return gate_.highIntervals(now_s()); }

std::vector<Exposure> Twin::takeExposures() { return std::exchange(exposures_, {}); }

Twin::Truth Twin::truth() const {
  const auto spot = model_.spot();
  return {static_cast<double>(steps_) * MachineModel::kStep_s, model_.beltTravel_mm(), emitted_j_,
          spot ? spot->p_WQ_mm : Eigen::Vector2d::Constant(std::nan(""))};
}

}  // namespace kerfbench::twin
