// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/place_anew.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/input_error.h"
#include "hil/desk/json_text.h"
#include "hil/desk/scenario_edit.h"
#include "hil/desk/sheet_place.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::desk {
namespace {

using Eigen::Vector2d;
using nlohmann::ordered_json;

/// The key below `dieline`, which becomes a section where it is the name of a file alone.
KeyEdit ofDrawing(const std::string& text, const std::string& key, ordered_json value) {
  const ordered_json before = valueIn(text, "dieline");
  if (before.is_string()) return {{"dieline"}, ordered_json{{"file", before}, {key, std::move(value)}}};
  return {{"dieline", key}, std::move(value)};
}

std::string withUnit(const std::string& text, const std::optional<std::string>& unit) {
  if (!unit) return text;
  if (!dieline::drawingUnitFromName(*unit))
    throw base::InputError(fmt::format("'{}' is none of the units mm, cm, in, pt, px", *unit));
  return edited(text, {ofDrawing(text, "unit", *unit)});
}

scenario::Scenario readAs(const std::string& text, const ScenarioText& scenario, const DeskRequest& request) {
  return scenario::draftScenario(scenario.file, text, {request.bin_dir.parent_path() / "firmware"}).scenario;
}

/// Box around what is cut, without the shift across the web; empty where the drawing cannot be read.
Eigen::AlignedBox2d boxOf(const scenario::Scenario& of, const base::ProgressFn& progress) {
  dieline::DrawingOptions options = of.drawing;
  options.progress = progress;
  options.shift_mm.y() = 0.0;
  return dieline::readDieline(of.dieline, options).bounds();
}

std::string sizeWords(const Eigen::AlignedBox2d& box) {
  return fmt::format("{:.1f} x {:.1f} mm", box.sizes().x(), box.sizes().y());
}

/// The title, if it tells the size that the drawing had before.
std::string withSize(const std::string& text, const scenario::Scenario& before,
                     const Eigen::AlignedBox2d& box_now, const base::ProgressFn& progress) {
  Eigen::AlignedBox2d box;
  try {
    box = boxOf(before, progress);
  } catch (const dieline::DielineError&) {
    return text;  // A unit was missing.
  }
  const std::string words = box.isEmpty() ? std::string() : sizeWords(box);
  std::string title = before.title;
  const std::size_t at = words.empty() ? std::string::npos : title.find(words);
  if (at == std::string::npos || words == sizeWords(box_now)) return text;
  return edited(text, {{{"title"}, title.replace(at, words.size(), sizeWords(box_now))}});
}

}  // namespace

std::string placeJson(const ScenarioText& scenario, const std::optional<std::string>& unit,
                      const DeskRequest& request) {
  std::string text = withUnit(scenario.text, unit);
  const scenario::Scenario of = readAs(text, scenario, request);
  if (of.dieline.empty() || of.machine.empty())
    throw base::InputError("There is no drawing and no machine to lay it under.");
  const Eigen::AlignedBox2d box = boxOf(of, request.progress);
  if (box.isEmpty()) throw base::InputError(of.dieline.string() + ": it holds no line that could be cut");
  const auto& told = machine_file::readMachineFile(of.machine).machine.controller;
  const SheetPlace place =
      placeOnSheet(box, Eigen::AlignedBox2d(Vector2d(told.field_min_mm[0], told.field_min_mm[1]),
                                            Vector2d(told.field_max_mm[0], told.field_max_mm[1])));
  ordered_json marks = ordered_json::array();
  for (const Vector2d& p : place.marks_mm)
    marks.push_back({{"x_mm", p.x()}, {"y_mm", p.y()}, {"diameter_mm", kMarkDiameter_mm}});
  if (of.drawing.shift_mm.y() != place.shift_y_mm)
    text = edited(text, {ofDrawing(text, "shift", {of.drawing.shift_mm.x(), place.shift_y_mm})});
  text = edited(text, {{{"print", "marks"}, std::move(marks)}, {{"print", "pitch_mm"}, place.pitch_mm}});
  if (!of.sheetMoves() && !of.belt_by_controller)
    text = edited(text, {{{"belt", "start_x_mm"}, place.start_x_mm}});
  text = withSize(text, readAs(scenario.text, scenario, request), box, request.progress);
  return jsonText({{"text", text}});
}

}  // namespace kerfbench::desk
