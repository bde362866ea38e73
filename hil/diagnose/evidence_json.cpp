// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/evidence_json.h"

#include <cmath>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace kerfbench::diagnose {
namespace {

using Json = nlohmann::ordered_json;

// One list of members serves both ways: a Writer puts them, a Reader gets them.

class Writer {
 public:
  static constexpr bool kReads = false;
  Json json = Json::array();

  void take(const double& value) {
    if (std::isfinite(value))
      json.push_back(std::stod(fmt::format("{:.10g}", value)));
    else
      json.push_back(nullptr);
  }
  void take(const Eigen::Vector2d& value) {
    take(value.x());
    take(value.y());
  }
  template <typename T>
  void take(const T& value) {
    json.push_back(value);
  }
  void take(const std::optional<std::int64_t>& value) {
    if (value)
      json.push_back(*value);
    else
      json.push_back(nullptr);
  }
};

class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(const Json& from) : json_(from) {}

  void take(double& value) {
    const Json& j = next();
    value = j.is_null() ? kUnknown : j.get<double>();
  }
  void take(Eigen::Vector2d& value) {
    take(value.x());
    take(value.y());
  }
  template <typename T>
  void take(T& value) {
    value = next().template get<T>();
  }
  void take(std::optional<std::int64_t>& value) {
    const Json& j = next();
    value.reset();
    if (!j.is_null()) value = j.get<std::int64_t>();
  }

 private:
  const Json& next() { return json_.at(at_++); }
  const Json& json_;
  std::size_t at_{};
};

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, MachineFacts> {
  v.take(x.gantry), v.take(x.throw_mm), v.take(x.spacing_mm), v.take(x.step_mm), v.take(x.mirror_step_urad);
  v.take(x.tracking_delay_s), v.take(x.encoder_count_mm), v.take(x.full_step_pulses), v.take(x.has_table);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, MachineSpread> {
  v.take(x.head_offset_mm), v.take(x.head_rotation_rad), v.take(x.head_scale), v.take(x.head_shear_rad);
  v.take(x.head_bend_mm), v.take(x.lag_s), v.take(x.backlash_mm), v.take(x.mark_mm), v.take(x.unit_mark_mm);
  v.take(x.encoder_scale);
}

template <typename V, typename T>
void headMembers(V& v, T& x) {
  v.take(x.time_s), v.take(x.p_mm), v.take(x.v_mm_s), v.take(x.a_mm_s2), v.take(x.flank);
  v.take(x.forward_mm);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, LineReading> {
  v.take(x.unit), v.take(x.entity), v.take(x.p_S_mm), v.take(x.normal), v.take(x.cut_mm),
      v.take(x.cut_sigma_mm);
  v.take(x.asked_mm), v.take(x.program_mm);
  headMembers(v, x.head);
  v.take(x.sheet.x_mm), v.take(x.sheet.speed_mm_s), v.take(x.sheet.since_mark_mm),
      v.take(x.sheet.off_plan_mm);
  v.take(x.table_mm);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, SpotReading> {
  v.take(x.unit);
  headMembers(v, x.head);
  v.take(x.away_mm), v.take(x.sigma_mm), v.take(x.table_mm);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, GateReading> {
  v.take(x.unit), v.take(x.entity), v.take(x.open_late_s), v.take(x.close_late_s), v.take(x.energy_share);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, DriveReading> {
  v.take(x.axis), v.take(x.step_mm), v.take(x.pulses), v.take(x.setup_violations);
  v.take(x.hold_violations), v.take(x.width_violations), v.take(x.space_violations), v.take(x.least_setup_s);
  v.take(x.setup_s), v.take(x.least_hold_s), v.take(x.hold_s), v.take(x.first_violation_s), v.take(x.told);
  v.take(x.seen);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, EntityReading> {
  v.take(x.unit), v.take(x.entity), v.take(x.coverage), v.take(x.passes), v.take(x.in_program);
  v.take(x.times_in_program);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, BeltReading> {
  v.take(x.ratio), v.take(x.ratio_sigma), v.take(x.travel_mm);
}

template <typename V, typename T>
void members(V& v, T& x) requires std::is_same_v<std::remove_const_t<T>, PowerSwing> {
  v.take(x.share), v.take(x.share_U), v.take(x.period_s);
}

template <typename V, typename T>
void scalars(V& v, T& e) {
  v.take(e.limit_mm), v.take(e.passed), v.take(e.failed), v.take(e.edges_judged), v.take(e.kerf_radius_mm);
  v.take(e.ordered_radius_mm), v.take(e.planned_speed_mm_s), v.take(e.sheet_moves),
      v.take(e.encoder_backwards), v.take(e.belt_travel_mm), v.take(e.openings), v.take(e.beam_unseen),
      v.take(e.burnt_elsewhere), v.take(e.belt_followed), v.take(e.drawing_centre_mm);
  v.take(e.stop), v.take(e.axes), v.take(e.gate_polarity), v.take(e.steady_power);
  v.take(e.corners);
}

template <typename T>
Json one(const T& x) {
  Writer writer;
  members(writer, x);
  return writer.json;
}

template <typename T>
Json optional(const std::optional<T>& x) {
  return x ? one(*x) : Json(nullptr);
}

template <typename T>
Json list(const std::vector<T>& from) {
  Json json = Json::array();
  for (const T& x : from) json.push_back(one(x));
  return json;
}

template <typename T>
void read(const Json& from, T& x) {
  Reader reader(from);
  members(reader, x);
}

template <typename T>
void read(const Json& from, std::optional<T>& to) {
  if (!from.is_null()) read(from, to.emplace());
}

template <typename T>
void read(const Json& from, std::vector<T>& to) {
  for (const Json& j : from) read(j, to.emplace_back());
}

}  // namespace

std::string evidenceJson(const Evidence& evidence) {
  Json json;
  Writer writer;
  scalars(writer, evidence);
  json["version"] = 6;
  json["run"] = writer.json;
  json["machine"] = one(evidence.machine);
  json["spread"] = one(evidence.spread);
  json["drives"] = list(evidence.drives);
  json["entities"] = list(evidence.entities);
  json["gates"] = list(evidence.gates);
  json["belt"] = optional(evidence.belt);
  json["power_swing"] = optional(evidence.power_swing);
  json["lines"] = list(evidence.lines);
  json["spots"] = list(evidence.spots);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Evidence evidenceFromJson(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("version") != 6) throw std::runtime_error("evidence of a diagnosis: another version");
    Evidence evidence;
    Reader reader(json.at("run"));
    scalars(reader, evidence);
    read(json.at("machine"), evidence.machine);
    read(json.at("spread"), evidence.spread);
    read(json.at("drives"), evidence.drives);
    read(json.at("entities"), evidence.entities);
    read(json.at("gates"), evidence.gates);
    read(json.at("belt"), evidence.belt);
    read(json.at("power_swing"), evidence.power_swing);
    read(json.at("lines"), evidence.lines);
    read(json.at("spots"), evidence.spots);
    return evidence;
  } catch (const Json::exception& e) {
    throw std::runtime_error(std::string("evidence of a diagnosis: ") + e.what());
  }
}

}  // namespace kerfbench::diagnose
