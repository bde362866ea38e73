// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "hil/base/config_text.h"
#include "hil/calibrate/files/day.h"
#include "hil/scenario/scenario_sections.h"

namespace kerfbench::scenario {
namespace {

/// What printing leaves of where marks are against each other, on one sheet of a press that is in register.
constexpr double kUsualPrint_um = 2.0;

namespace fs = std::filesystem;

template <typename Value, std::size_t n>
Value fromName(const std::array<const char*, n>& names, const std::string& name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw std::out_of_range("no such name: " + name);
  return static_cast<Value>(found - names.begin());
}

template <std::size_t n>
std::string readChoice(base::YamlReader& file, std::string_view key,
                       const std::array<const char*, n>& names) {
  const std::vector<std::string> allowed(names.begin(), names.end());
  const std::string name = file.choice(key, allowed, allowed.front());
  return std::ranges::find(allowed, name) == allowed.end() ? allowed.front() : name;
}

inspect::Tolerances::Edge readEdge(base::YamlReader& checks) {
  using Edge = inspect::Tolerances::Edge;
  const std::string edge = checks.choice("edge", {"none", "nesting", "outside", "inside"}, "none");
  if (edge == "nesting") return Edge::kNesting;
  if (edge == "outside") return Edge::kOutside;
  return edge == "inside" ? Edge::kInside : Edge::kCentre;
}

/// The side of open cuts, by default that which the planner is told.
inspect::Tolerances::OpenCuts readOpenCuts(base::YamlReader& checks, const planner::JobParameters& job) {
  using OpenCuts = inspect::Tolerances::OpenCuts;
  using Told = planner::JobParameters::OpenCuts;
  const bool beside = job.kerf_radius_mm > 0.0;
  const std::string told = beside && job.open_cuts == Told::kLeft    ? "left"
                           : beside && job.open_cuts == Told::kRight ? "right"
                                                                     : "line";
  const std::string side = checks.choice("open_cuts", {"line", "left", "right"}, told);
  return side == "left" ? OpenCuts::kLeft : side == "right" ? OpenCuts::kRight : OpenCuts::kCentre;
}

inspect::Tolerances::OrderedDepth readDepth(base::YamlReader depth) {
  const inspect::Tolerances::OrderedDepth order{depth.number("min", {.min = 0, .max = 1, .fallback = 0.0}),
                                                depth.number("max", {.min = 0, .max = 1, .fallback = 0.0})};
  if (order.least >= order.most && (order.most > 0.0 || order.least > 0.0))
    depth.fault("min", "must be less than max");
  return order;
}

/// What the cut is to be. Without an order of its own a perforation is held against what the planner is told;
/// where another plans, nothing is ordered.
void readOrder(base::YamlReader& checks, const Scenario& s, inspect::Tolerances& tolerances) {
  const bool planned = s.firmware.dialog == FirmwareChoice::Dialog::kKerfbench && s.job_gcode.empty();
  auto perforation = checks.section("perforation");
  auto& order = tolerances.perforation;
  order.cut_mm = perforation.number(
      "cut_mm", {.min = 0.3, .max = 50, .fallback = planned ? s.job.perforation_cut_mm : 0.0});
  order.bridge_mm = perforation.number(
      "bridge_mm", {.min = 0.3, .max = 50, .fallback = planned ? s.job.perforation_gap_mm : 0.0});
  order.limit_mm = perforation.number("limit_mm", {.min = 0.05, .max = 10, .fallback = order.limit_mm});
  if ((order.cut_mm > 0.0) != (order.bridge_mm > 0.0))
    perforation.fault("cut_mm", "needs bridge_mm, and the other way round");
  auto width = checks.section("ordered_width");
  tolerances.ordered_width.nominal_mm = width.number("nominal_mm", {.min = 0, .max = 2, .fallback = 0.0});
  tolerances.ordered_width.limit_mm =
      width.number("limit_mm", {.min = 0.001, .max = 2, .fallback = tolerances.ordered_width.limit_mm});
  tolerances.crease_depth = readDepth(checks.section("crease_depth"));
  tolerances.half_cut_depth = readDepth(checks.section("half_cut_depth"));
}

inspect::Tolerances readTolerances(base::YamlReader& checks, const Scenario& s) {
  inspect::Tolerances tolerances;
  tolerances.edge = readEdge(checks);
  tolerances.open_cuts = readOpenCuts(checks, s.job);
  const auto read = [&](const char* key, double min, double max, double& value) {
    value = checks.number(key, {.min = min, .max = max, .fallback = value});
  };
  read("path_mm", 0.001, 10, tolerances.path_mm);
  read("stillness_mm", 0.001, 10, tolerances.stillness_mm);
  read("uncut_mm", 0.1, 100, tolerances.uncut_mm);
  read("uncut_share", 1e-4, 1, tolerances.uncut_share);
  read("cut_through_mm", 0.1, 100, tolerances.cut_through_mm);
  read("kerf_width_mm", 0.001, 10, tolerances.kerf_width_mm);
  read("even_depth_share", 0, 1, tolerances.even_depth_share);
  tolerances.depth_points =
      static_cast<int>(checks.integer("even_depth_points", {.min = 0, .max = 1000, .fallback = 0.0}));
  if (tolerances.depth_points > 0 && !(tolerances.even_depth_share > 0.0))
    checks.fault("even_depth_points", "needs even_depth_share, the limit that they are held against");
  read("line_energy_j_mm", 0, 100, tolerances.line_energy_j_mm);
  read("line_energy_share", 1e-4, 1, tolerances.line_energy_share);
  double gate_lag_ms = 1e3 * tolerances.gate_lag_s;
  read("gate_lag_ms", 0.01, 100, gate_lag_ms);
  tolerances.gate_lag_s = 1e-3 * gate_lag_ms;
  read("stray_mm", 0.15, 100, tolerances.stray_mm);
  readOrder(checks, s, tolerances);
  return tolerances;
}

void readName(base::YamlReader& file, Scenario& s) {
  constexpr std::size_t kLongestName = 100;
  constexpr const char* kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  s.name = file.text("name");
  if (s.name.empty() || s.name.find_first_not_of(kAllowed) != std::string::npos || s.name.front() == '.')
    file.fault("name", "use letters, digits, '-', '_' and '.': it names the results folder");
  // With what is added to it, a replay's name for one, it has to be a name of a file still.
  if (s.name.size() > kLongestName)
    file.fault("name", fmt::format("has {} letters, and at most {} make a folder's name", s.name.size(),
                                   kLongestName));
  s.title = file.text("title", "");
}

void readWires(base::YamlReader& file, Scenario& s) {
  for (const auto& [name, wire] : file.pairs("wires")) {
    const std::optional<Signal> signal = signalFromName(name);
    const bool is_twice =
        std::ranges::find(s.wires, wire, &decltype(s.wires)::value_type::second) != s.wires.end();
    if (!signal) file.fault("wires", fmt::format("'{}' is no signal", name));
    if (is_twice) file.fault("wires", fmt::format("the wire '{}' is given to two signals", wire));
    if (signal && !is_twice) s.wires.emplace_back(*signal, wire);
  }
}

void readRelease(base::YamlReader& file, const ImagePath& images, Scenario& s) {
  s.firmware = readFirmware(file.section("firmware"), images);
  if (s.firmware.onRealPins() && s.belt_by_controller) {
    file.fault(
        "belt",
        "drive must be line on real pins (source: gpio, analyser): where the controller feeds, its own pins "
        "move the encoder, and the model knows of them too late");
  }
  if (s.firmware.source == FirmwareChoice::Source::kAnalyser && s.sheetMoves()) {
    file.fault("belt",
               "speed_mm_s must be 0 where an analyser listens (source: analyser): it drives neither encoder "
               "nor print mark, so the sheet lies at rest");
  }
}

void readPlanner(base::YamlReader planner, Scenario& s) {
  s.job = readJob(planner, s);
  if (planner.has("gcode")) s.job_gcode = fileOf(planner, "gcode");
  if (planner.has("jump_radius_mm")) {
    s.jump_radius_mm = planner.number("jump_radius_mm", {.min = -1, .max = 1000});
    if (*s.jump_radius_mm < 0.0 && *s.jump_radius_mm != planner::kRadiusOfDrawing)
      planner.fault("jump_radius_mm", "is a radius, 0 for straight jumps, or -1 for that of the drawing");
  }
  s.planner_faults = readPlannerFaults(planner.section("faults"));
}

void readProvocation(base::YamlReader& file, Scenario& s) {
  s.provoke = readProvoke(file.section("provoke"), s.belt_speed_mm_s > 0.0 && !s.belt_by_controller);
  if (s.provoke.cause == ProvokeChoice::Cause::kNone) return;
  if (s.firmware.dialog != FirmwareChoice::Dialog::kKerfbench)
    file.fault("provoke", "the safe states are those of the reference controller (dialog: kerfbench)");
  if (s.firmware.onRealPins())
    file.fault("provoke",
               "is for emulated releases; on real pins (source: gpio, analyser) nothing is provoked yet");
}

void readChecks(base::YamlReader& file, Scenario& s) {
  auto checks = file.section("checks");
  s.limits = readTolerances(checks, s);
  s.limits.board_transmission = s.board.transmission;  // As the board's data sheet has it.
  s.limits.board_thickness_mm = s.board.thickness_mm;
  s.calibration_max_age_days = static_cast<int>(checks.integer(
      "calibration_max_age_days", {.min = 0, .max = 36500, .fallback = s.calibration_max_age_days}));
  s.date = file.text("date", "");
  if (!s.date.empty() && !calibrate::dayNumber(s.date)) file.fault("date", "is no day like 2026-11-21");
}

}  // namespace

fs::path fileOf(base::YamlReader& reader, std::string_view key, const fs::path& second_base) {
  const std::string name = reader.text(key);
  if (name.empty()) return {};
  for (const fs::path& folder : {reader.folderOf(key), second_base}) {
    const fs::path candidate = fs::absolute(folder / name).lexically_normal();
    if (!fs::is_regular_file(candidate)) continue;
    reader.names(candidate);
    return candidate;
  }
  reader.fault(key, fmt::format("no such file '{}'{}", name,
                                second_base.empty()
                                    ? ""
                                    : " (looked beside the scenario and in " + second_base.string() + ")"));
  return {};
}

twin::Preset presetFromName(const std::string& name) { return fromName<twin::Preset>(kPresetNames, name); }
twin::Fidelity fidelityFromName(const std::string& name) {
  return fromName<twin::Fidelity>(kFidelityNames, name);
}

namespace {

/// All sections, one after the other; faults stay with the reader.
Scenario readAll(base::YamlReader& file, const fs::path& path, const ImagePath& images) {
  Scenario s;
  s.path = fs::absolute(path).lexically_normal();
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  readName(file, s);
  readDrawing(file, s);
  s.machine = fileOf(file, "machine");
  readWires(file, s);
  s.selection = readSelection(file.section("select"));
  auto board = file.section("board");
  s.board = readBoard(board);
  s.swelling_sigma =
      1e-6 * board.number("swelling_ppm", {.min = 0, .max = 10000, .fallback = kUsualSwelling_ppm});
  auto print = file.section("print");
  s.print = readPrint(print);
  s.print_sigma_mm =
      1e-3 * print.number("registration_um", {.min = 0, .max = 500, .fallback = kUsualPrint_um});
  readBelt(file.section("belt"), s);
  readRelease(file, images, s);
  readPlanner(file.section("planner"), s);
  readProvocation(file, s);
  s.cameras = readCameraChoice(file.section("cameras"));
  readChecks(file, s);
  s.time_limit_s = file.number("time_limit_s", {.min = 0.01, .max = 3600, .fallback = 60.0});
  s.seed = static_cast<std::uint64_t>(file.integer("seed", {.min = 0, .max = 9e15, .fallback = 1.0}));
  s.imperfections = presetFromName(readChoice(file, "imperfections", kPresetNames));
  s.fidelity = fidelityFromName(readChoice(file, "twin", kFidelityNames));
  s.inputs = file.inputs();
  return s;
}

}  // namespace

ScenarioFile readScenarioFile(const fs::path& path, const ImagePath& images) {
  const std::string text = base::configText(path);
  auto file = base::YamlReader::openText(path, text);
  ScenarioFile result{readAll(file, path, images), file.asked()};
  result.scenario.text = text;
  file.finish();
  return result;
}

ScenarioDraft draftScenario(const fs::path& path, const std::string& text, const ImagePath& images) {
  auto file = base::YamlReader::openText(path, text);
  ScenarioDraft draft{readAll(file, path, images), file.asked(), file.faults()};
  draft.scenario.text = text;
  return draft;
}

Scenario readScenario(const fs::path& path, const ImagePath& images) {
  return readScenarioFile(path, images).scenario;
}

}  // namespace kerfbench::scenario
