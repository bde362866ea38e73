// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/machine_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hil/dieline/geometry.h"
#include "hil/evidence/pin_evidence.h"
#include "hil/judge/machine_pictures.h"
#include "hil/judge/pin_wiring.h"
#include "hil/trace/run/moving_scene_json.h"
#include "twin/scene/moving_scene.h"

namespace kerfbench::trace {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDielineChord_mm = 0.01;

Json pairOf(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }

const char* nameOf(ProgramOrigin origin) {
  static constexpr std::array kNames{"sent", "recorded", "planned"};
  return kNames.at(static_cast<std::size_t>(origin));
}

void addFieldOf(const twin::ControllerDescription& told, Json& json) {
  const Eigen::Vector2d min_mm(told.field_min_mm[0], told.field_min_mm[1]);
  const Eigen::Vector2d max_mm(told.field_max_mm[0], told.field_max_mm[1]);
  json["views"]["sheet"] = {{"min_mm", {min_mm.x(), min_mm.y(), 0.0}},
                            {"max_mm", {max_mm.x(), max_mm.y(), 0.0}},
                            {"body", Json()},
                            {"look", {0.0, 0.0, -1.0}}};
  json["field"] = {{"min_mm", pairOf(min_mm)}, {"max_mm", pairOf(max_mm)}};
}

Json idOrNull(const WiredSignals& signals, Signal signal) {
  const std::optional<int> id = signals.idOf(signal);
  return id ? Json(*id) : Json();
}

Json signalsOf(const WiredSignals& signals) {
  Json all = Json::array();
  for (std::size_t i = 0; i < signals.signals().size(); ++i) {
    const Signal signal = signals.signals()[i];
    all.push_back(
        {{"id", i}, {"name", signalName(signal)}, {"from", isSensor(signal) ? "machine" : "controller"}});
  }
  return all;
}

Json drivesOf(const evidence::PinWiring& wiring, const WiredSignals& signals) {
  Json all = Json::array();
  for (const evidence::DriveWiring& drive : wiring.drives) {
    const std::optional<int> pul = signals.idOf(drive.pul);
    const std::optional<int> dir = signals.idOf(drive.dir);
    if (!pul || !dir) continue;
    const DriverProfile& profile = drive.profile;
    all.push_back({{"axis", drive.axis},
                   {"pul", *pul},
                   {"dir", *dir},
                   {"enable", idOrNull(signals, enableOf(drive.pul))},
                   {"active_edge", profile.active_edge_rising ? "rising" : "falling"},
                   {"setup_s", profile.setup_s},
                   {"hold_s", profile.hold_s},
                   {"width_s", profile.width_s},
                   {"space_s", profile.space_s},
                   {"dir_low", profile.dir_low},
                   {"enable_low", profile.enable_low},
                   {"enable_setup_s", profile.enable_setup_s}});
  }
  return all;
}

Json webFacts(const twin::WebDescription& web, const Eigen::AlignedBox2d& unit) {
  Json marks = Json::array();
  for (const RegistrationMark& mark : web.print.marks)
    marks.push_back(
        {{"x_mm", mark.p_SM_mm.x()}, {"y_mm", mark.p_SM_mm.y()}, {"diameter_mm", mark.diameter_mm}});
  return {
      {"start_x_mm", web.start_x_mm},
      {"pitch_mm", web.print.pitch_mm},
      {"units", web.print.units},
      {"thickness_mm", web.board.thickness_mm},
      {"unit",
       {{"min_mm", pairOf(Eigen::Vector2d(unit.min()))}, {"max_mm", pairOf(Eigen::Vector2d(unit.max()))}}},
      {"marks", marks},
      {"eye_mark", {{"x_mm", web.print.eye_mark_x_mm}, {"length_mm", web.print.eye_mark_length_mm}}}};
}

/// Points of a curve, no chord farther from it than the limit. A circle of radius r needs chords of
/// sqrt(8 r limit); other curves are halved until their chords' middles are near enough.
Json pointsOf(const dieline::Curve& curve) {
  Json points = Json::array();
  const std::vector<double> ends = dieline::stations(curve, 1.0);
  const auto add = [&](const auto& self, double from, double to, int depth) -> void {
    const Eigen::Vector2d a = dieline::pointAt(curve, from);
    const Eigen::Vector2d b = dieline::pointAt(curve, to);
    const double middle = 0.5 * (from + to);
    constexpr int kDeepest = 12;
    if (depth < kDeepest && (dieline::pointAt(curve, middle) - 0.5 * (a + b)).norm() > kDielineChord_mm) {
      self(self, from, middle, depth + 1);
      self(self, middle, to, depth + 1);
      return;
    }
    points.push_back({std::round(b.x() * 1e4) / 1e4, std::round(b.y() * 1e4) / 1e4});
  };
  const Eigen::Vector2d first = dieline::pointAt(curve, ends.front());
  points.push_back({std::round(first.x() * 1e4) / 1e4, std::round(first.y() * 1e4) / 1e4});
  for (std::size_t i = 1; i < ends.size(); ++i) add(add, ends[i - 1], ends[i], 0);
  return points;
}

Json dielineOf(const dieline::Dieline& dieline) {
  Json lines = Json::array();
  for (const dieline::Entity& entity : dieline.entities) {
    Json points = pointsOf(entity.curve);
    const bool closed = points.size() > 2 && points.front() == points.back();
    lines.push_back({{"entity", entity.id},
                     {"process", dieline::processName(entity.process)},
                     {"layer", entity.layer},
                     {"points_mm", std::move(points)},
                     {"closed", closed}});
  }
  return lines;
}

Json linesOf(const std::string& gcode) {
  Json lines = Json::array();
  std::istringstream text(gcode);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::string machineMessage(const MachineFacts& facts) {
  const scenario::Case& test_case = facts.test_case;
  const twin::MachineDescription& machine = facts.machine;
  const evidence::PinWiring wiring = judge::pinWiring(test_case);
  const Eigen::AlignedBox2d unit = judge::unitOf(*test_case.dieline);
  const twin::WebDescription web = scenario::webOn(machine, test_case);
  twin::SceneContent content;
  content.unit_S_mm = unit;
  Json json{{"machine", machine.name},
            {"scenario", test_case.scenario.name},
            {"title", test_case.scenario.title},
            {"tick_hz", static_cast<double>(facts.rate.den) / static_cast<double>(facts.rate.num)},
            {"period_s", facts.program.period_s ? Json(*facts.program.period_s) : Json()},
            {"quantum_s", facts.quantum_s},
            {"time_limit_s", test_case.scenario.time_limit_s},
            {"signals", signalsOf(facts.signals)},
            {"drives", drivesOf(wiring, facts.signals)},
            {"laser",
             {{"gate", idOrNull(facts.signals, Signal::kLaserGate)},
              {"pwm", idOrNull(facts.signals, Signal::kLaserPwm)},
              {"gate_low", wiring.gate_low},
              {"pwm_low", wiring.pwm_low},
              {"full_power_w", machine.laser.full_power_w}}},
            {"encoder",
             {{"a", idOrNull(facts.signals, Signal::kEncoderA)},
              {"b", idOrNull(facts.signals, Signal::kEncoderB)},
              {"count_mm", wiring.encoder_count_mm}}}};
  Json columns = Json::array();
  for (const twin::PoseColumn column : twin::poseColumnsOf(machine))
    columns.push_back(twin::poseColumnName(column));
  for (const char* name : {"spot_x_mm", "spot_y_mm", "spot_z_mm", "power_w", "lit"}) columns.push_back(name);
  json["columns"] = columns;
  json.update(jsonOf(twin::movingScene(machine, web, content)));
  addFieldOf(machine.controller, json);
  json["web"] = webFacts(web, unit);
  json["dieline"] = dielineOf(*test_case.dieline);
  json["gcode"] = linesOf(facts.program.gcode);
  json["gcode_from"] = facts.program.gcode.empty() ? Json() : Json(nameOf(facts.program.from));
  json["belt_mm_s"] = test_case.scenario.belt_speed_mm_s;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerfbench::trace
