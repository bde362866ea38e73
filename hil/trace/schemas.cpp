// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/schemas.h"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

namespace kerfbench::trace {
namespace {

using Json = nlohmann::ordered_json;
using Fields = std::vector<std::pair<std::string, Json>>;

Json number() { return {{"type", "number"}}; }
Json integer() { return {{"type", "integer"}}; }
Json text() { return {{"type", "string"}}; }
Json truth() { return {{"type", "boolean"}}; }
/// The same, or null.
Json orNull(Json type) {
  type["type"] = Json::array({type["type"], "null"});
  return type;
}
Json oneOf(std::initializer_list<const char*> values) {
  Json list = Json::array();
  for (const char* value : values) list.push_back(value);
  return {{"type", "string"}, {"enum", list}};
}
Json listOf(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json listOf(const Json& items, int count) {
  return {{"type", "array"}, {"items", items}, {"minItems", count}, {"maxItems", count}};
}
Json bit() { return {{"type", "integer"}, {"minimum", 0}, {"maximum", 1}}; }

/// An object that has all of `required`, may have `optional`, and has nothing else.
Json object(const Fields& required, const Fields& optional = {}) {
  Json properties = Json::object();
  Json names = Json::array();
  for (const auto& [name, type] : required) {
    properties[name] = type;
    names.push_back(name);
  }
  for (const auto& [name, type] : optional) properties[name] = type;
  return {
      {"type", "object"}, {"properties", properties}, {"required", names}, {"additionalProperties", false}};
}

std::string schema(const std::string& title, const std::string& description, Json body) {
  Json whole{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
             {"title", title},
             {"description", description}};
  whole.update(body);
  return whole.dump();
}

Fields columns(std::initializer_list<const char*> names, const Json& type) {
  Fields fields;
  for (const char* name : names) fields.emplace_back(name, listOf(type));
  return fields;
}

Fields joined(std::initializer_list<Fields> parts) {
  Fields all;
  for (const Fields& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Json vector() { return listOf(number(), 3); }
Json place() { return listOf(number(), 2); }

Json shape() {
  return {{"oneOf",
           Json::array(
               {object({{"box", object({{"size_mm", vector()}, {"edge_radius_mm", number()}})}}),
                object({{"cylinder",
                         object({{"radius_mm", number()}, {"length_mm", number()}, {"bore_mm", number()}})}}),
                object({{"disc", object({{"radius_mm", place()}, {"thickness_mm", number()}})}}),
                object({{"cone", object({{"radius_mm", number()}, {"length_mm", number()}})}})})}};
}

Json part() {
  const Json clip{{"oneOf", Json::array({object({{"cut_x_mm", place()}}),
                                         object({{"within_x_mm", place()}, {"at_mm", vector()}})})}};
  return object(
      {{"name", text()},
       {"material", oneOf({"steel", "aluminium", "paint", "dark", "belt", "belt_hole", "board", "print",
                           "mirror", "glass", "tube", "axis_x", "axis_y", "axis_z", "light"})},
       {"body", orNull(integer())},
       {"pose", listOf(number(), 7)},
       {"shape", shape()}},
      {{"repeat", object({{"count", integer()}, {"step_mm", vector()}})}, {"clip", clip}});
}

Json bodies() {
  const Json joint = object({{"kind", oneOf({"slide", "turn"})},
                             {"axis", vector()},
                             {"origin_mm", vector()},
                             {"by", text()},
                             {"scale", number()}},
                            {{"wrap_mm", number()}});
  return listOf(object({{"name", text()}, {"parent", orNull(integer())}, {"joints", listOf(joint)}}));
}

Json beam() {
  const Json corner{
      {"oneOf",
       Json::array({object({{"at_mm", vector()}, {"body", orNull(integer())}, {"radius_mm", number()}},
                           {{"direction", vector()}}),
                    object({{"mirror", integer()}, {"radius_mm", number()}}),
                    object({{"plane", object({{"at_mm", vector()}, {"normal", vector()}})},
                            {"radius_mm", number()}})})}};
  return object({{"from", listOf(corner)}, {"spot_radius_mm", number()}});
}

Json drive() {
  return object({{"axis", text()},
                 {"pul", integer()},
                 {"dir", integer()},
                 {"enable", orNull(integer())},
                 {"active_edge", oneOf({"rising", "falling"})},
                 {"setup_s", number()},
                 {"hold_s", number()},
                 {"width_s", number()},
                 {"space_s", number()},
                 {"dir_low", truth()},
                 {"enable_low", truth()},
                 {"enable_setup_s", number()}});
}

Json web() {
  return object(
      {{"start_x_mm", number()},
       {"pitch_mm", number()},
       {"units", integer()},
       {"thickness_mm", number()},
       {"unit", object({{"min_mm", place()}, {"max_mm", place()}})},
       {"marks", listOf(object({{"x_mm", number()}, {"y_mm", number()}, {"diameter_mm", number()}}))},
       {"eye_mark", object({{"x_mm", number()}, {"length_mm", number()}})}});
}

}  // namespace

std::string machineSchema() {
  const Json signal =
      object({{"id", integer()}, {"name", text()}, {"from", oneOf({"controller", "machine"})}});
  const Json view = object(
      {{"min_mm", vector()}, {"max_mm", vector()}, {"body", orNull(integer())}, {"look", orNull(vector())}});
  const Json line = object({{"entity", integer()},
                            {"process", text()},
                            {"layer", text()},
                            {"points_mm", listOf(place())},
                            {"closed", truth()}});
  return schema(
      "Machine",
      "What does not change: the machine as bodies and parts, its signals, the job. Lengths in mm, frame W.",
      object(
          {{"machine", text()},
           {"scenario", text()},
           {"title", text()},
           {"tick_hz", number()},
           {"period_s", orNull(number())},
           {"quantum_s", number()},
           {"time_limit_s", number()},
           {"signals", listOf(signal)},
           {"drives", listOf(drive())},
           {"laser", object({{"gate", orNull(integer())},
                             {"pwm", orNull(integer())},
                             {"gate_low", truth()},
                             {"pwm_low", truth()},
                             {"full_power_w", number()}})},
           {"encoder", object({{"a", orNull(integer())}, {"b", orNull(integer())}, {"count_mm", number()}})},
           {"columns", listOf(text())},
           {"bodies", bodies()},
           {"parts", listOf(part())},
           {"beam", beam()},
           {"views", object({{"overall", view}, {"head", view}, {"sheet", view}})},
           {"field", object({{"min_mm", place()}, {"max_mm", place()}})},
           {"web", web()},
           {"dieline", listOf(line)},
           {"gcode", listOf(text())},
           {"gcode_from", Json{{"enum", Json::array({"sent", "recorded", "planned", nullptr})}}},
           {"belt_mm_s", number()}}));
}

std::string motionSchema() {
  return schema(
      "Motion",
      "Where the machine was, by the model: a row for each quantum. Lengths in mm, angles in rad, frame W.",
      object(joined({columns({"t_s", "roller_mm", "belt_mm", "slip_x_mm", "slip_y_mm", "frame_x_mm",
                              "frame_y_mm"},
                             number()),
                     columns({"spot_x_mm", "spot_y_mm", "spot_z_mm"}, orNull(number())),
                     columns({"power_w"}, number()), columns({"lit"}, bit())}),
             columns({"gantry_x_mm", "gantry_y_mm", "mirror_x_rad", "mirror_y_rad"}, number())));
}

std::string pinsSchema() {
  const Json count{{"type", "integer"}, {"minimum", 0}};
  return schema(
      "Pins", "Edges by tick: the first dt counts from tick0, each other from the edge before.",
      object(joined({{{"tick0", count}}, columns({"dt", "id"}, count), columns({"level"}, bit())})));
}

std::string commandedSchema() {
  return schema("Commanded", "Where the pulses have led the beam, frame W, mm.",
                object(joined({columns({"t_s"}, number()), columns({"x_mm", "y_mm"}, orNull(number()))})));
}

std::string gcodeSchema() {
  return schema("Gcode", "A row for each change of the line that the pulses are on; line 0: none.",
                object(joined({columns({"t_s"}, number()), columns({"line", "unit"}, integer())})));
}

std::string uartSchema() {
  return schema("Log", "What went over the controller's serial line.",
                object({{"timestamp", object({{"sec", integer()}, {"nsec", integer()}})},
                        {"level", integer()},
                        {"message", text()},
                        {"name", oneOf({"controller", "bench"})},
                        {"file", text()},
                        {"line", integer()},
                        {"hex", text()}}));
}

std::string burntSchema() {
  return schema("Burnt", "The lit path on the sheet, in S of unit 0, mm; start 1: a path begins.",
                object(joined({columns({"t_s", "x_mm", "y_mm"}, number()), columns({"start"}, bit())})));
}

std::string overviewSchema() {
  const Json pin = object({{"id", integer()}, {"edges", listOf(integer())}, {"level", listOf(bit())}});
  const Json extent = object({{"min", listOf(orNull(number()))}, {"max", listOf(orNull(number()))}});
  return schema(
      "Overview",
      "A row for each interval: edges and last level of each signal, least and most of each column.",
      object({{"from_s", number()},
              {"step_s", number()},
              {"rows", integer()},
              {"pins", listOf(pin)},
              {"columns", {{"type", "object"}, {"additionalProperties", extent}}},
              {"lit_s", listOf(number())}}));
}

std::string spotSchema() {
  return schema("Spot", "What the spot camera measured, a row for each frame.",
                object(joined({columns({"t_s"}, number()),
                               columns({"x_mm", "y_mm", "sigma_mm", "sheet_x_mm", "sheet_y_mm", "sheet_rad",
                                        "deviation_mm", "x_px", "y_px"},
                                       orNull(number())),
                               columns({"unit", "entity"}, integer())})));
}

std::string framesSchema() {
  const Json window =
      object({{"x_px", integer()}, {"y_px", integer()}, {"width_px", integer()}, {"height_px", integer()}});
  Json data = text();
  data["contentEncoding"] = "base64";
  return schema("CompressedImage", "A picture of the spot camera, or a window of one.",
                object({{"timestamp", object({{"sec", integer()}, {"nsec", integer()}})},
                        {"frame_id", text()},
                        {"data", data},
                        {"format", oneOf({"png"})},
                        {"sequence", integer()},
                        {"start_s", number()},
                        {"exposure_s", number()},
                        {"windows", listOf(window)},
                        {"width_px", integer()},
                        {"height_px", integer()}}));
}

std::string checkSchema() {
  return schema("Check", "A check of the verdict.",
                object({{"name", text()},
                        {"title", text()},
                        {"outcome", oneOf({"PASS", "FAIL", "NOT PROVEN", "INVALID"})},
                        {"value", orNull(number())},
                        {"limit", orNull(number())},
                        {"upper", truth()},
                        {"u", orNull(number())},
                        {"unit", text()},
                        {"subject", text()},
                        {"sentence", text()},
                        {"time_s", orNull(number())},
                        {"within_s", number()},
                        {"sheet_unit", integer()},
                        {"entity", integer()},
                        {"x_mm", orNull(number())},
                        {"y_mm", orNull(number())}}));
}

}  // namespace kerfbench::trace
