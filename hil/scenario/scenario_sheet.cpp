// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/scenario_sections.h"

#include <fmt/format.h>

#include <cstddef>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace kerfbench::scenario {
namespace {

constexpr double kHuge = 1e9;
constexpr std::size_t kMostPoints = 1000;  // Longest list.

const std::map<std::string, twin::LightLaw> kLightLaws{{"beer", twin::LightLaw::kBeer},
                                                       {"scatter", twin::LightLaw::kScatter},
                                                       {"linear", twin::LightLaw::kLinear}};

std::vector<twin::DepthPoint> readDepthCurve(base::YamlReader& board) {
  std::vector<twin::DepthPoint> curve;
  auto points = board.list("depth_curve");
  if (points.size() > kMostPoints) {
    board.fault("depth_curve", fmt::format("has more than {} points", kMostPoints));
    return curve;
  }
  bool ascends = true;
  for (base::YamlReader& point : points) {
    const twin::DepthPoint next{point.number("fluence_share", {.min = 0, .max = 1}),
                                point.number("depth_share", {.min = 0, .max = 1})};
    ascends = ascends && (curve.empty() || (next.fluence_share > curve.back().fluence_share &&
                                            next.depth_share > curve.back().depth_share));
    curve.push_back(next);
  }
  if (!ascends) board.fault("depth_curve", "must ascend in both shares");
  if (!curve.empty() &&
      (curve.front().depth_share != 0 || curve.back().depth_share != 1 || curve.back().fluence_share != 1)) {
    board.fault(
        "depth_curve",
        "must go from depth_share 0 to {fluence_share: 1, depth_share: 1}: there the board is through");
  }
  return curve;
}

twin::ScorchDescription readScorch(base::YamlReader scorch) {
  twin::ScorchDescription result;
  result.fluence_j_mm2 = scorch.number("fluence_j_mm2", {.min = 0, .max = 100, .fallback = 0.0});
  result.darkening = scorch.number("darkening", {.min = 0, .max = 1, .fallback = result.darkening});
  const auto shift = scorch.numbers("shift_mm", 2, {.min = -1, .max = 1, .fallback = 0.0});
  result.shift_mm = {shift[0], shift[1]};
  return result;
}

// Print in addition to the marks.
std::vector<PrintedArea> readAreas(base::YamlReader& print) {
  std::vector<PrintedArea> areas;
  auto entries = print.list("areas");
  if (entries.size() > kMostPoints) {
    print.fault("areas", fmt::format("has more than {} areas", kMostPoints));
    return areas;
  }
  for (base::YamlReader& entry : entries) {
    PrintedArea area;
    area.p_SA_mm = {entry.number("x_mm", {.min = -1e4, .max = 1e4}),
                    entry.number("y_mm", {.min = -1e4, .max = 1e4})};
    const auto size = entry.numbers("size_mm", 2, {.min = 0.01, .max = 1e4});
    area.size_mm = {size[0], size[1]};
    area.angle_rad =
        std::numbers::pi / 180.0 * entry.number("angle_deg", {.min = -360, .max = 360, .fallback = 0.0});
    area.ink = entry.number("ink", {.min = 0, .max = 1, .fallback = 1.0});
    areas.push_back(area);
  }
  return areas;
}

// A word, or the speeds of the line that are to come.
std::vector<twin::SpeedPoint> readSpeedChanges(base::YamlReader& belt) {
  if (!belt.isList("profile")) {
    belt.choice("profile", {"constant"}, "constant");
    return {};
  }
  std::vector<twin::SpeedPoint> changes;
  auto points = belt.list("profile");
  if (points.size() > kMostPoints) {
    belt.fault("profile", fmt::format("has more than {} points", kMostPoints));
    return changes;
  }
  for (base::YamlReader& point : points) {
    const twin::SpeedPoint next{point.number("at_s", {.min = 1e-6, .max = 36000}),
                                point.number("speed_mm_s", {.min = -5000, .max = 5000})};
    if (!changes.empty() && next.time_s <= changes.back().time_s)
      point.fault("at_s", "must be later than the point before");
    changes.push_back(next);
  }
  return changes;
}

/// The speeds that the belt may have, and whether its profile keeps to them.
void readBeltRange(base::YamlReader& belt, Scenario& s) {
  s.belt_min_mm_s = belt.number("min_mm_s", {.min = 0, .max = 5000, .fallback = 0.0});
  s.belt_max_mm_s = belt.number("max_mm_s", {.min = 0, .max = 5000, .fallback = 0.0});
  const double most_mm_s = s.belt_max_mm_s > 0.0 ? s.belt_max_mm_s : kHuge;
  for (const twin::SpeedPoint& change : s.belt_speed_changes) {
    if (change.speed_mm_s < s.belt_min_mm_s || change.speed_mm_s > most_mm_s)
      belt.fault("profile", fmt::format("{:g} mm/s at {:g} s is outside of min_mm_s and max_mm_s",
                                        change.speed_mm_s, change.time_s));
  }
}

}  // namespace

dieline::LayerProfile readLayers(base::YamlReader& file) {
  const auto rules = file.leaves("layers");
  if (rules.empty()) return dieline::defaultLayerProfile();
  dieline::LayerProfile profile{"scenario", {}};
  for (const auto& [path, process] : rules) {
    const std::string fault = dieline::addLayerRule(profile, path, process);
    if (!fault.empty()) file.fault("layers", fault);
  }
  return profile;
}

void readDrawing(base::YamlReader& file, Scenario& s) {
  s.drawing.layers = readLayers(file);
  if (!file.isMapping("dieline")) {
    s.dieline = fileOf(file, "dieline");
    return;
  }
  auto drawing = file.section("dieline");
  s.dieline = fileOf(drawing, "file");
  if (drawing.has("unit")) {
    const std::string unit = drawing.choice("unit", {"mm", "cm", "in", "pt", "px"});
    s.drawing.unit = dieline::drawingUnitFromName(unit);
  }
  if (drawing.has("page"))
    s.drawing.page = static_cast<int>(drawing.integer("page", {.min = 1, .max = 9999}));
  s.drawing.scale = drawing.number("scale", {.min = 1e-6, .max = 1e6, .fallback = 1.0});
  s.drawing.turn_deg = drawing.number("turn", {.min = -360, .max = 360, .fallback = 0.0});
  const auto shift = drawing.numbers("shift", 2, {.min = -1e5, .max = 1e5, .fallback = 0.0});
  s.drawing.shift_mm = {shift[0], shift[1]};
  s.drawing.once = drawing.boolean("once", false);
  s.witness_required = drawing.choice("witness", {"none", "required"}, "none") == "required";
  for (const std::string& name : drawing.texts("accept")) {
    const auto kind = dieline::lintKindFromName(name);
    if (kind)
      s.accepted.insert(*kind);
    else
      drawing.fault("accept", fmt::format("'{}' is none of duplicate, overlap, gap, zero-length", name));
  }
}

planner::Selection readSelection(base::YamlReader select) {
  const std::string entities = select.text("entities", "");
  const std::string layers = select.text("layers", "");
  const std::string process = select.text("process", "");
  planner::Selection selection;
  const auto limit = [&](const char* key, auto part) {
    try {
      part();
    } catch (const planner::PlanError& error) {
      select.fault(key, error.what());
    }
  };
  limit("entities", [&] { selection.entities = planner::selectionFrom(entities, "", "").entities; });
  limit("layers", [&] { selection.layers = planner::selectionFrom("", layers, "").layers; });
  limit("process", [&] { selection.processes = planner::selectionFrom("", "", process).processes; });
  return selection;
}

twin::BoardDescription readBoard(base::YamlReader& board) {
  twin::BoardDescription result;
  result.thickness_mm =
      board.number("thickness_mm", {.min = 0.001, .max = 5.0, .fallback = result.thickness_mm});
  result.cut_fluence_j_mm2 =
      board.number("cut_fluence_j_mm2", {.min = 0.001, .max = 100.0, .fallback = result.cut_fluence_j_mm2});
  const std::string law = board.text("light", "beer");
  if (const auto found = kLightLaws.find(law); found != kLightLaws.end())
    result.light_law = found->second;
  else
    board.fault("light", fmt::format("'{}' is none of beer, scatter, linear", law));
  result.transmission =
      board.number("transmission", {.min = 0.01, .max = 0.5, .fallback = result.transmission});
  result.print_transmission =
      board.number("print_transmission", {.min = 0.0, .max = 0.5, .fallback = result.print_transmission});
  result.depth_curve = readDepthCurve(board);
  result.scorch = readScorch(board.section("scorch"));
  return result;
}

PrintLayout readPrint(base::YamlReader& print) {
  PrintLayout result;
  result.units = static_cast<int>(print.integer("units", {.min = 1, .max = 10000, .fallback = 1.0}));
  result.pitch_mm = print.number("pitch_mm", {.min = 1.0, .max = 10000.0});
  result.eye_mark_x_mm = print.number("eye_mark_x_mm", {.min = -10000.0, .max = 10000.0, .fallback = 0.0});
  result.eye_mark_length_mm = print.number("eye_mark_length_mm", {.min = 0.5, .max = 100.0, .fallback = 5.0});
  if (print.has("pitch_mm") && result.eye_mark_length_mm >= result.pitch_mm) {
    print.fault("eye_mark_length_mm",
                "must be less than pitch_mm: the sensor would see one mark without end");
  }
  auto marks = print.list("marks");
  if (marks.size() > kMostPoints) {
    print.fault("marks", fmt::format("has more than {} marks", kMostPoints));
    marks.erase(marks.begin() + kMostPoints, marks.end());
  }
  for (base::YamlReader& mark : marks) {
    RegistrationMark m;
    m.p_SM_mm = {mark.number("x_mm", {.min = -kHuge, .max = kHuge}),
                 mark.number("y_mm", {.min = -kHuge, .max = kHuge})};
    m.diameter_mm = mark.number("diameter_mm", {.min = 1.0, .max = 20.0, .fallback = 3.0});
    result.marks.push_back(m);
  }
  result.areas = readAreas(print);
  if (result.marks.size() < 3)
    print.fault("marks", "needs at least three registration marks: they define the sheet's frame");
  return result;
}

void readBelt(base::YamlReader belt, Scenario& s) {
  s.belt_speed_mm_s = belt.number("speed_mm_s", {.min = 0, .max = 5000});
  s.belt_speed_changes = readSpeedChanges(belt);
  readBeltRange(belt, s);
  s.belt_by_controller = belt.choice("drive", {"line", "controller"}, "line") == "controller";
  if (s.belt_by_controller && !s.belt_speed_changes.empty())
    belt.fault("profile", "is the line's; here the controller feeds");
  s.belt_lead_s = belt.number("lead_s", {.min = 0.05, .max = 60, .fallback = 0.8});
  if (belt.has("start_x_mm")) {
    s.web_start_x_mm = belt.number("start_x_mm", {.min = -1e5, .max = 1e5});
  } else if (s.belt_speed_mm_s == 0 && !s.belt_by_controller) {
    belt.fault("speed_mm_s",
               "a belt at rest brings no sheet under the head: say where it lies with start_x_mm");
  }
}

}  // namespace kerfbench::scenario
