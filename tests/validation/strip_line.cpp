// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/strip_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kerfbench::validation {
namespace {

using twin::BeamSpot;
using twin::MachineModel;

constexpr Tick kQuantum = 8000;  // 0.5 ms
/// Length that is burnt at either end of a cut; more than the beam reaches.
constexpr double kBurntEnd_mm = 2.0;

bool crossed(double before, double now, double goal) { return (before - goal) * (now - goal) <= 0.0; }

}  // namespace

twin::BoardDescription stripBoard() {
  twin::BoardDescription board;
  board.thickness_mm = 0.7;
  return board;
}

twin::WebDescription stripWeb(const StripJob& job) {
  twin::WebDescription web;
  web.board = stripBoard();
  web.print.pitch_mm = job.length_mm;
  web.print.eye_mark_length_mm = 5.0;
  web.fed_by_controller = job.regime == StripJob::Regime::kStopAndGo;
  web.belt_speed_mm_s = web.fed_by_controller ? 0.0 : job.feed_mm_s;
  return web;
}

StripLine::StripLine(const twin::MachineDescription& machine, const StripJob& job, twin::Fidelity fidelity)
    : machine_(machine),
      job_(job),
      controller_(job, machine, kStripRate),
      model_(machine, stripWeb(job), fidelity),
      laser_(machine.laser, 1),
      board_(stripBoard()),
      sheet_(board_),
      pins_(machine, stripWeb(job), kStripRate) {}

double StripLine::time_s() const { return static_cast<double>(steps_) * MachineModel::kStep_s; }

void StripLine::readPins() {
  events_.clear();
  controller_.advance(now_ + kQuantum, events_);
  now_ += kQuantum;
  for (const PinEvent& event : events_) pins_.decode(event, model_);
  pins_.settle(now_, model_);
}

StripLine::View StripLine::view() const {
  const twin::MachinePose pose = model_.pose();
  const auto spot = model_.spot();
  if (!spot) throw std::runtime_error("the beam misses the strip");
  return {*spot, pose.belt_travel_mm + pose.sheet_slip_mm.x()};
}

double StripLine::emit(double begin_s) {
  // A step in which the gate moves is divided there, as in Twin.
  const double input_time_s = begin_s - machine_.laser.gate_delay_s;
  const double end_s = input_time_s + MachineModel::kStep_s;
  double from_s = input_time_s;
  double energy_j = 0.0;
  const auto until = [&](double to_s) {
    if (to_s <= from_s) return;
    const double duty = pins_.pwm().meanOver(from_s, to_s);
    energy_j += laser_.step(gate_open_ ? 1.0 : 0.0, duty, begin_s + (from_s - input_time_s), to_s - from_s);
    from_s = to_s;
  };
  for (twin::EdgeQueue& edges = pins_.gateEdges(); edges.front_s() < end_s; edges.pop()) {
    until(edges.front_s());
    gate_open_ = !gate_open_;
  }
  until(end_s);
  return energy_j;
}

void StripLine::step() {
  const double begin_s = time_s();
  const double energy_j = emit(begin_s);
  model_.run(steps_, 1);
  ++steps_;
  // The spot costs as much as the dynamics, and outside of the strip it is not needed.
  const double y = StripController::sense(number_) * model_.pose().gantry_mm.y();
  if (!watcher_ && y < -0.5 * job_.width_mm - kBurntEnd_mm) {
    last_.reset();
    return;
  }
  const View now = view();
  if (last_ && !off_) follow(*last_, now, energy_j);
  last_ = now;
  if (watcher_) watcher_(time_s(), now.spot.p_WQ_mm);
}

void StripLine::follow(const View& before, const View& now, double energy_j) {
  const double sense = StripController::sense(number_);
  const double edge_mm = 0.5 * job_.width_mm;
  const double y_before = sense * before.spot.p_WQ_mm.y();
  const double y = sense * now.spot.p_WQ_mm.y();
  // Place on the sheet, from the line of this cut and from the strip's middle.
  const auto onSheet = [line_mm = number_ * job_.length_mm](const View& view) {
    const BeamSpot& spot = view.spot;
    return twin::Footprint{{spot.p_WQ_mm.x() - view.web_mm + line_mm, spot.p_WQ_mm.y()},
                           spot.radius_x_mm,
                           spot.radius_y_mm,
                           spot.correlation};
  };
  const twin::Footprint footprint = onSheet(now);
  const double x = footprint.p_SQ_mm.x();
  if (crossed(y_before, y, -edge_mm)) piece_.near_mm = x;
  if (crossed(y_before, y, edge_mm)) piece_.far_mm = x;
  // The beam still runs outwards, out of the cut before.
  if (y > y_before && std::abs(y) < edge_mm) {
    if (energy_j > 0.0) {
      piece_.worst_mm = std::max(piece_.worst_mm, std::abs(x));
    } else {
      piece_.unlit_mm += std::abs(y - y_before);
    }
    piece_.energy_j_mm += energy_j / job_.width_mm;
  }
  if (std::abs(std::abs(y) - edge_mm) > kBurntEnd_mm) return;
  sheet_.burn(onSheet(before), footprint, energy_j);
  if (y > edge_mm - 0.5 && sheet_.depthAt({x, sense * edge_mm}) >= 1.0) {
    off_ = true;
    piece_.cut_s = time_s();
    if (y < edge_mm) piece_.far_mm = x;  // The kerf runs ahead of the beam's middle.
  }
}

CutPiece StripLine::nextPiece() {
  off_ = false;
  piece_ = {};
  sheet_ = twin::Sheet(board_);
  const double cycle_s = job_.formula_s(2) - job_.formula_s(1);
  const double latest_s = time_s() + 3.0 * cycle_s + 10.0;
  while (!off_) {
    if (time_s() > latest_s) {
      throw std::runtime_error("piece " + std::to_string(number_) + " does not come off the strip");
    }
    readPins();
    while (static_cast<double>(steps_ + 1) * MachineModel::kStep_s <= kStripRate.seconds(now_) + 1e-12)
      step();
  }
  ++number_;
  return piece_;
}

}  // namespace kerfbench::validation
