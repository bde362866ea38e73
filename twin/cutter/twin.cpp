// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/twin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "twin/cutter/machine_faults.h"

namespace kerfbench::twin {
namespace {

constexpr std::uint64_t kStepsPerSecond = 100'000;

const MachineDescription& checked(const MachineDescription& machine, const WebDescription& web) {
  std::string text;
  for (const std::string& fault : faultsOf(machine, web)) text += (text.empty() ? "machine: " : "; ") + fault;
  if (!text.empty()) throw std::invalid_argument(text);
  return machine;
}

double firstMarkTravel_mm(const MachineDescription& machine, const WebDescription& web) {
  return machine.belt.print_mark_sensor.x_mm - (web.start_x_mm + web.print.eye_mark_x_mm);
}

double between(double a, double b, double share) { return a + share * (b - a); }

Footprint between(const Footprint& a, const Footprint& b, double share) {
  return {a.p_SQ_mm + share * (b.p_SQ_mm - a.p_SQ_mm), between(a.radius_x_mm, b.radius_x_mm, share),
          between(a.radius_y_mm, b.radius_y_mm, share), between(a.correlation, b.correlation, share)};
}

Footprint footprint(const BeamSpot& spot, const Eigen::Vector2d& p_WS_mm) {
  return {spot.p_WQ_mm - p_WS_mm, spot.radius_x_mm, spot.radius_y_mm, spot.correlation};
}

/// Radius of the round spot with the same area.
double roundRadius_mm(const BeamSpot& spot) {
  return std::sqrt(spot.radius_x_mm * spot.radius_y_mm *
                   std::sqrt(1.0 - spot.correlation * spot.correlation));
}

}  // namespace

Twin::Twin(const MachineDescription& machine, const WebDescription& web, TickRate rate,
           const TwinOptions& options)
    : machine_(checked(machine, web)),
      web_(web),
      rate_(rate),
      record_exposures_(options.record_exposures),
      monitor_wired_(machine.signals.pin(Signal::kPowerMonitor).has_value()),
      model_(machine, web, options.fidelity),
      pins_(machine, web, rate),
      laser_(machine.laser, options.seed),
      burner_(web.board),
      exposures_(machine.spot_camera, MachineModel::kStep_s),
      encoder_(rate, machine.belt.encoder, machine.belt.roller_radius_mm, options.seed),
      mark_sensor_(rate, machine.belt.print_mark_sensor, web.print, firstMarkTravel_mm(machine, web),
                   options.seed),
      limits_(rate, machine.travel_min_mm, machine.travel_max_mm),
      monitor_(rate, machine.power_monitor) {}

double Twin::longestQuantum_s() const {
  // The last step of the machine ends up to a step before now.
  return monitor_wired_ ? machine_.power_monitor.delay_s - MachineModel::kStep_s
                        : std::numeric_limits<double>::infinity();
}

std::vector<SensorEdge> Twin::predictSensors(Tick until) {
  std::vector<SensorEdge> edges;
  if (!predicting_) edges.push_back({now_ + 1, Signal::kInterlock, true});
  predicting_ = true;
  monitor_.connect();
  // The machine's state is that of its last whole step, a fraction of a step before now.
  const double behind_s = now_s() - time_s();
  const MachinePose pose = model_.pose();
  const auto forecast = [&](double place_mm, double speed_mm_s, double acceleration_mm_s2) {
    return MotionForecast{now_, place_mm + speed_mm_s * behind_s, speed_mm_s, acceleration_mm_s2};
  };
  encoder_.predict(forecast(pose.roller_mm, model_.rollerSpeed_mm_s(), model_.rollerAcceleration_mm_s2()),
                   until, edges);
  mark_sensor_.predict(forecast(pose.belt_travel_mm + pose.sheet_slip_mm.x(), model_.sheetSpeed_mm_s(),
                                model_.sheetAcceleration_mm_s2()),
                       until, edges);
  if (machine_.kind == MachineDescription::Kind::kGantry) {
    const Eigen::Vector2d speed_mm_s = model_.gantrySpeed_mm_s();
    limits_.predict({forecast(pose.gantry_mm.x(), speed_mm_s.x(), 0.0),
                     forecast(pose.gantry_mm.y(), speed_mm_s.y(), 0.0)},
                    until, edges);
  }
  if (monitor_wired_) monitor_.predict(now_, until, edges);
  std::ranges::stable_sort(edges, {}, &SensorEdge::tick);
  return edges;
}

std::uint64_t Twin::wholeSteps(Tick tick) const {
  // The product is exact: whole seconds' worth of `num` come first, so that nothing overflows within a
  // century.
  const std::uint64_t whole = tick / rate_.den;
  const std::uint64_t rest = tick % rate_.den;
  return whole * rate_.num * kStepsPerSecond + rest * rate_.num * kStepsPerSecond / rate_.den;
}

void Twin::advance(Tick until, std::span<const PinEvent> events) {
  for (const PinEvent& event : events) pins_.decode(event, model_);
  now_ = until;
  pins_.settle(until, model_);
  // Only whole steps are made: the remainder belongs to the next quantum, so that quanta leave no trace.
  const std::uint64_t end = wholeSteps(until);
  while (steps_ < end) stepMachine();
  runModel();
}

void Twin::runModel() {
  if (model_steps_ == steps_) return;
  model_.run(model_steps_, steps_ - model_steps_);
  model_steps_ = steps_;
}

void Twin::stepMachine() {
  const double begin_s = time_s();
  emit(begin_s);
  const bool exposing = record_exposures_ && exposures_.nextStep();
  const bool whole = emissions_.size() == 1 && emissions_[0].begin == 0.0 && emissions_[0].end == 1.0;
  const bool parts = !emissions_.empty() && !whole;
  if (burner_.chordOpen() && !whole) closeChord();
  // The beam's place costs as much as half of the dynamics: it is not computed while the beam is dark or amid
  // a chord. Until somebody asks for it the moving parts are left behind: they run faster many steps at once.
  View before;
  if (exposing || parts) before = view();
  if (whole && !burner_.chordOpen()) openChord();
  ++steps_;
  if (burner_.chordOpen() && burner_.add(emissions_[0].energy_j)) closeChord();
  if (parts) burnParts(before, view());
  if (exposing) expose(before, view());
}

void Twin::emit(double begin_s) {
  emissions_.clear();
  const double input_time_s = begin_s - machine_.laser.gate_delay_s;
  const double end_s = input_time_s + MachineModel::kStep_s;
  if (!gate_open_ && laser_.dark() && pins_.gateEdges().front_s() >= end_s) return;
  double from_s = input_time_s;
  // A step in which the gate changes is divided there, so that its energy falls where the beam was.
  for (EdgeQueue& edges = pins_.gateEdges(); edges.front_s() < end_s; edges.pop()) {
    const double edge_s = edges.front_s();
    if (edge_s > from_s) {
      emitPart(input_time_s, from_s, edge_s);
      from_s = edge_s;
    }
    gate_open_ = !gate_open_;
  }
  emitPart(input_time_s, from_s, end_s);
}

void Twin::emitPart(double input_time_s, double from_s, double to_s) {
  const double duty = pins_.pwm().meanOver(from_s, to_s);
  const bool begins = from_s == input_time_s;
  const bool ends = to_s == input_time_s + MachineModel::kStep_s;
  const double begin = begins ? 0.0 : (from_s - input_time_s) / MachineModel::kStep_s;
  const double end = ends ? 1.0 : (to_s - input_time_s) / MachineModel::kStep_s;
  const double part_s = begins && ends ? MachineModel::kStep_s : to_s - from_s;
  const double part_begin_s = time_s() + begin * MachineModel::kStep_s;
  const double energy_j = laser_.step(gate_open_ ? 1.0 : 0.0, duty, part_begin_s, part_s);
  if (energy_j <= 0.0) return;
  emitted_j_ += energy_j;
  emissions_.push_back({begin, end, energy_j});
  if (monitor_wired_) monitor_.emitted(energy_j, part_begin_s, part_s);
}

const Twin::View& Twin::view() {
  if (viewed_step_ == steps_) return view_;
  runModel();
  const MachinePose pose = model_.pose();
  view_ = {model_.spot(),
           {web_.start_x_mm + pose.belt_travel_mm + pose.sheet_slip_mm.x(), pose.sheet_slip_mm.y()}};
  viewed_step_ = steps_;
  return view_;
}

const Sheet& Twin::sheet() {
  if (burner_.chordOpen()) closeChord();
  return burner_.sheet();
}

double Twin::webX_mm() const {
  const MachinePose pose = model_.pose();
  return web_.start_x_mm + pose.belt_travel_mm + pose.sheet_slip_mm.x();
}

void Twin::openChord() {
  if (view().spot) burner_.open(footprint(view().spot.value(), view().p_WS_mm));
}

void Twin::closeChord() {
  if (view().spot) {
    burner_.close(footprint(view().spot.value(), view().p_WS_mm));
  } else {
    burner_.drop();
  }
}

void Twin::burnParts(const View& before, const View& after) {
  if (!before.spot || !after.spot) return;
  const Footprint from = footprint(*before.spot, before.p_WS_mm);
  const Footprint to = footprint(*after.spot, after.p_WS_mm);
  for (const Emission& part : emissions_) {
    burner_.burn(between(from, to, part.begin), between(from, to, part.end), part.energy_j);
  }
}

void Twin::expose(const View& before, const View& after) {
  ExposureSample sample;
  sample.p_WS_mm = 0.5 * (before.p_WS_mm + after.p_WS_mm);
  sample.radius_mm = machine_.beam.waist_radius_mm;
  if (before.spot && after.spot) {
    double energy_j = 0.0;
    for (const Emission& part : emissions_) energy_j += part.energy_j;
    sample.p_WQ_mm = 0.5 * (before.spot->p_WQ_mm + after.spot->p_WQ_mm);
    sample.radius_mm = 0.5 * (roundRadius_mm(*before.spot) + roundRadius_mm(*after.spot));
    sample.power_w = energy_j / MachineModel::kStep_s;
  }
  exposures_.record(sample);
}

Twin::Truth Twin::truth() const {
  const auto spot = model_.spot();
  return {time_s(), model_.pose().belt_travel_mm, emitted_j_,
          spot ? spot->p_WQ_mm : Eigen::Vector2d::Constant(std::nan(""))};
}

}  // namespace kerfbench::twin
