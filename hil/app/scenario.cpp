// SPDX-License-Identifier: Apache-2.0
#include "hil/app/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "firmware_under_test/planner/power/model.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/day.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

constexpr double kHuge = 1e9;
constexpr std::size_t kMostPoints = 1000;  // Of a list.

const std::map<std::string, Process> kProcesses{{"cut", Process::kCut},
                                                {"half-cut", Process::kHalfCut},
                                                {"crease", Process::kCrease},
                                                {"perforation", Process::kPerforation},
                                                {"ignore", Process::kIgnore}};

fs::path fileOf(YamlReader& reader, std::string_view key, const fs::path& second_base = {}) {
  const std::string name = reader.text(key);
  if (name.empty()) return {};
  for (const fs::path& folder : {reader.folderOf(key), second_base}) {
    const fs::path candidate = fs::absolute(folder / name).lexically_normal();
    if (fs::is_regular_file(candidate)) return candidate;
  }
  reader.fault(key, fmt::format("no such file '{}'{}", name,
                                second_base.empty()
                                    ? ""
                                    : " (looked beside the scenario and in " + second_base.string() + ")"));
  return {};
}

LayerProfile readLayers(YamlReader& file) {
  const auto rules = file.pairs("layers");
  if (rules.empty()) return defaultLayerProfile();
  LayerProfile profile{"scenario", {}};
  for (const auto& [layer, process] : rules) {
    const auto found = kProcesses.find(process);
    if (found == kProcesses.end()) {
      file.fault("layers", fmt::format("'{}: {}' is none of cut, half-cut, crease, perforation, ignore",
                                       layer, process));
    } else {
      profile.rules[layer] = found->second;
    }
  }
  return profile;
}

planner::Selection readSelection(YamlReader select) {
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

std::vector<twin::DepthPoint> readDepthCurve(YamlReader& board) {
  std::vector<twin::DepthPoint> curve;
  auto points = board.list("depth_curve");
  if (points.size() > kMostPoints) {
    board.fault("depth_curve", fmt::format("has more than {} points", kMostPoints));
    return curve;
  }
  bool ascends = true;
  for (YamlReader& point : points) {
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

twin::ScorchDescription readScorch(YamlReader scorch) {
  twin::ScorchDescription result;
  result.fluence_j_mm2 = scorch.number("fluence_j_mm2", {.min = 0, .max = 100, .fallback = 0.0});
  result.darkening = scorch.number("darkening", {.min = 0, .max = 1, .fallback = result.darkening});
  const auto shift = scorch.numbers("shift_mm", 2, {.min = -1, .max = 1, .fallback = 0.0});
  result.shift_mm = {shift[0], shift[1]};
  return result;
}

twin::BoardDescription readBoard(YamlReader board) {
  twin::BoardDescription result;
  result.thickness_mm =
      board.number("thickness_mm", {.min = 0.05, .max = 5.0, .fallback = result.thickness_mm});
  result.cut_fluence_j_mm2 =
      board.number("cut_fluence_j_mm2", {.min = 0.001, .max = 100.0, .fallback = result.cut_fluence_j_mm2});
  result.transmission =
      board.number("transmission", {.min = 0.01, .max = 0.5, .fallback = result.transmission});
  result.print_transmission =
      board.number("print_transmission", {.min = 0.0, .max = 0.5, .fallback = result.print_transmission});
  result.depth_curve = readDepthCurve(board);
  result.scorch = readScorch(board.section("scorch"));
  return result;
}

// Other print beside the marks.
std::vector<PrintedArea> readAreas(YamlReader& print) {
  std::vector<PrintedArea> areas;
  auto entries = print.list("areas");
  if (entries.size() > kMostPoints) {
    print.fault("areas", fmt::format("has more than {} areas", kMostPoints));
    return areas;
  }
  for (YamlReader& entry : entries) {
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

PrintLayout readPrint(YamlReader print) {
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
  for (YamlReader& mark : marks) {
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

// A word, or the speeds of the line that are to come.
std::vector<twin::SpeedPoint> readSpeedChanges(YamlReader& belt) {
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
  for (YamlReader& point : points) {
    const twin::SpeedPoint next{point.number("at_s", {.min = 1e-6, .max = 36000}),
                                point.number("speed_mm_s", {.min = -5000, .max = 5000})};
    if (!changes.empty() && next.time_s <= changes.back().time_s)
      point.fault("at_s", "must be later than the point before");
    changes.push_back(next);
  }
  return changes;
}

void readBelt(YamlReader belt, Scenario& s) {
  s.belt_speed_mm_s = belt.number("speed_mm_s", {.min = 0, .max = 5000});
  s.belt_speed_changes = readSpeedChanges(belt);
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

template <typename Value, std::size_t n>
Value fromName(const std::array<const char*, n>& names, const std::string& name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw std::out_of_range("no such name: " + name);
  return static_cast<Value>(found - names.begin());
}

template <std::size_t n>
std::string readName(YamlReader& file, std::string_view key, const std::array<const char*, n>& names) {
  const std::vector<std::string> allowed(names.begin(), names.end());
  const std::string name = file.choice(key, allowed, allowed.front());
  return std::ranges::find(allowed, name) == allowed.end() ? allowed.front() : name;
}

void readDialog(YamlReader& firmware, FirmwareChoice& result) {
  result.baud =
      static_cast<std::uint32_t>(firmware.integer("baud", {.min = 300, .max = 4e6, .fallback = 250e3}));
  if (firmware.choice("dialog", {"kerfbench", "line-ok"}, "kerfbench") == "line-ok") {
    result.dialog = FirmwareChoice::Dialog::kLineOk;
    result.gcode = fileOf(firmware, "gcode");
  }
}

/// Of a scenario with another source that this one extends.
void skipKeys(const YamlReader& firmware, const std::vector<const char*>& keys) {
  for (const char* key : keys) (void)firmware.has(key);
}

FirmwareChoice readFirmwareOnPins(YamlReader& firmware, const ImagePath& images) {
  FirmwareChoice result;
  result.source = FirmwareChoice::Source::kGpio;
  result.gpio = readGpioChoice(firmware);
  if (result.gpio.uart.empty()) {
    result.dialog = FirmwareChoice::Dialog::kNone;
    skipKeys(firmware, {"image", "baud", "dialog", "gcode"});
  } else {
    if (firmware.has("image")) result.image = fileOf(firmware, "image", images.firmware_dir);
    readDialog(firmware, result);
  }
  skipKeys(firmware, {"child", "mcu", "clock_hz"});
  return result;
}

FirmwareChoice readFirmwareOnAnalyser(YamlReader& firmware) {
  FirmwareChoice result;
  result.source = FirmwareChoice::Source::kAnalyser;
  result.dialog = FirmwareChoice::Dialog::kNone;
  result.analyser = readAnalyserChoice(firmware);
  skipKeys(firmware, {"image", "child", "mcu", "clock_hz", "baud", "dialog", "gcode", "chip", "stamp_err_us",
                      "out_chip", "max_lag_us", "uart_wait_s"});
  for (const char* key : {"outputs", "uart"}) {
    if (firmware.has(key))
      firmware.fault(key, "is for source: gpio; an analyser drives nothing and talks to no controller");
  }
  return result;
}

FirmwareChoice readFirmware(YamlReader firmware, const ImagePath& images) {
  const std::string source = firmware.choice("source", {"avr", "native", "child", "gpio", "analyser"});
  if (source == "gpio") return readFirmwareOnPins(firmware, images);
  if (source == "analyser") return readFirmwareOnAnalyser(firmware);
  FirmwareChoice result;
  result.source = source == "native"  ? FirmwareChoice::Source::kNative
                  : source == "child" ? FirmwareChoice::Source::kChild
                                      : FirmwareChoice::Source::kAvr;
  result.image = fileOf(firmware, "image", images.firmware_dir);
  if (result.source == FirmwareChoice::Source::kChild)
    result.child = fileOf(firmware, "child", images.firmware_dir);
  result.mcu = firmware.text("mcu", result.mcu);
  result.clock_hz =
      static_cast<std::uint64_t>(firmware.integer("clock_hz", {.min = 1e5, .max = 1e9, .fallback = 16e6}));
  readDialog(firmware, result);
  return result;
}

/// S3: by depth, with a material and a laser, instead of by energy per length.
std::shared_ptr<const planner::PowerModel> readPower(YamlReader& power) {
  const fs::path material = fileOf(power, "material");
  const fs::path laser = fileOf(power, "laser");
  planner::PowerWish wish{.spot_diameter_mm = power.number("spot_diameter_mm", {.min = 0.01, .max = 10}),
                          .depth_mm = power.number("depth_mm", {.min = 1e-4, .max = 100}),
                          .half_depth_mm = std::nullopt};
  if (power.has("half_depth_mm"))
    wish.half_depth_mm = power.number("half_depth_mm", {.min = 1e-4, .max = 100});
  const auto read = [&](const char* key, const fs::path& file, auto reader) {
    decltype(std::optional(reader(file))) library;
    try {
      if (!file.empty()) library = reader(file);
    } catch (const planner::PowerError& error) {
      power.fault(key, fmt::format("cannot be used:\n{}", error.what()));
    }
    return library;
  };
  const auto the_material = read("material", material, planner::readMaterial);
  const auto the_laser = read("laser", laser, planner::readLaser);
  if (!the_material || !the_laser) return nullptr;
  try {
    return std::make_shared<planner::PowerModel>(*the_material, *the_laser, wish);
  } catch (const planner::PowerError& error) {
    power.fault("depth_mm", error.what());
    return nullptr;
  }
}

planner::JobParameters readJob(YamlReader planner, const Scenario& scenario) {
  planner::JobParameters job;
  job.belt_speed_mm_s = scenario.belt_speed_mm_s;
  job.mark_speed_mm_s =
      planner.number("mark_speed_mm_s", {.min = 1, .max = 5000, .fallback = job.mark_speed_mm_s});
  job.jump_speed_mm_s =
      planner.number("jump_speed_mm_s", {.min = 1, .max = 5000, .fallback = job.jump_speed_mm_s});
  job.acceleration_mm_s2 =
      planner.number("acceleration_mm_s2", {.min = 10, .max = 1e6, .fallback = job.acceleration_mm_s2});
  job.jump_acceleration_mm_s2 =
      planner.number("jump_acceleration_mm_s2", {.min = 0, .max = 1e6, .fallback = 0.0});
  // Who sends G-code of his own needs no planner.
  const bool planned = scenario.firmware.dialog == FirmwareChoice::Dialog::kKerfbench;
  const bool by_depth = planner.has("power");
  job.cut_energy_j_per_mm = planner.number(
      "cut_energy_j_per_mm",
      {1e-4, 10, planned && !by_depth ? std::nullopt : std::optional(job.cut_energy_j_per_mm)});
  if (by_depth) {
    YamlReader power = planner.section("power");
    job.power = readPower(power);
    job.power_loop = power.boolean("closed_loop", false);
  }
  job.jerk_mm_s3 = planner.number("jerk_mm_s3", {.min = 0, .max = 1e12, .fallback = 0.0});
  job.half_z = planner.number("half_z", {.min = 0.05, .max = 0.95, .fallback = job.half_z});
  job.perforation_cut_mm =
      planner.number("perforation_cut_mm", {.min = 0.3, .max = 50, .fallback = job.perforation_cut_mm});
  job.perforation_gap_mm =
      planner.number("perforation_gap_mm", {.min = 0.3, .max = 50, .fallback = job.perforation_gap_mm});
  job.alternate = planner.boolean("alternate", false);
  job.stop_and_go = planner.boolean("stop_and_go", false);
  if (job.stop_and_go && !scenario.belt_by_controller)
    planner.fault("stop_and_go", "needs belt.drive: controller, whose feed it is");
  const std::string order = planner.choice("order", {"shortest", "nearest", "drawn"}, "shortest");
  job.order = order == "drawn"     ? planner::JobParameters::Order::kDrawn
              : order == "nearest" ? planner::JobParameters::Order::kNearest
                                   : planner::JobParameters::Order::kShortest;
  job.kerf_radius_mm = planner.number("kerf_radius_mm", {.min = 0, .max = 2, .fallback = 0.0});
  const std::string open_cuts = planner.choice("open_cuts", {"line", "left", "right"}, "line");
  job.open_cuts = open_cuts == "left"    ? planner::JobParameters::OpenCuts::kLeft
                  : open_cuts == "right" ? planner::JobParameters::OpenCuts::kRight
                                         : planner::JobParameters::OpenCuts::kOnTheLine;
  job.allow_lost_features = planner.boolean("allow_lost_features", false);
  job.feed_by_controller = scenario.belt_by_controller;
  job.units = scenario.print.units;
  job.pitch_mm = scenario.print.pitch_mm;
  job.eye_mark_x_mm = scenario.print.eye_mark_x_mm;
  return job;
}

planner::PlannerFaults readPlannerFaults(YamlReader faults) {
  planner::PlannerFaults result;
  result.ignore_belt = faults.boolean("ignore_belt", false);
  result.mean_speed = faults.boolean("mean_speed", false);
  result.no_pincushion = faults.boolean("no_pincushion", false);
  result.no_mirror_limit = faults.boolean("no_mirror_limit", false);
  result.return_unchecked = faults.boolean("return_unchecked", false);
  result.kerf_wrong_side = faults.boolean("kerf_wrong_side", false);
  result.constant_power = faults.boolean("constant_power", false);
  result.skip_entity =
      static_cast<int>(faults.integer("skip_entity", {.min = -1, .max = 1e6, .fallback = -1.0}));
  result.repeat_entity =
      static_cast<int>(faults.integer("repeat_entity", {.min = -1, .max = 1e6, .fallback = -1.0}));
  return result;
}

Limits readLimits(YamlReader& checks) {
  Limits limits;
  const std::string edge = checks.choice("edge", {"none", "nesting", "outside", "inside"}, "none");
  limits.edge = edge == "nesting"   ? Limits::Edge::kNesting
                : edge == "outside" ? Limits::Edge::kOutside
                : edge == "inside"  ? Limits::Edge::kInside
                                    : Limits::Edge::kCentre;
  limits.path_mm = checks.number("path_mm", {.min = 0.001, .max = 10, .fallback = limits.path_mm});
  limits.stillness_mm =
      checks.number("stillness_mm", {.min = 0.001, .max = 10, .fallback = limits.stillness_mm});
  limits.min_coverage =
      checks.number("min_coverage", {.min = 0.5, .max = 1.0, .fallback = limits.min_coverage});
  limits.kerf_width_mm =
      checks.number("kerf_width_mm", {.min = 0.001, .max = 10, .fallback = limits.kerf_width_mm});
  limits.even_depth_share =
      checks.number("even_depth_share", {.min = 0, .max = 1, .fallback = limits.even_depth_share});
  limits.line_energy_j_mm =
      checks.number("line_energy_j_mm", {.min = 0, .max = 100, .fallback = limits.line_energy_j_mm});
  limits.line_energy_share =
      checks.number("line_energy_share", {.min = 1e-4, .max = 1, .fallback = limits.line_energy_share});
  limits.gate_lag_s =
      1e-3 * checks.number("gate_lag_ms", {.min = 0.01, .max = 100, .fallback = 1e3 * limits.gate_lag_s});
  limits.stray_mm = checks.number("stray_mm", {.min = 0.05, .max = 100, .fallback = limits.stray_mm});
  return limits;
}

}  // namespace

twin::Preset presetFromName(const std::string& name) { return fromName<twin::Preset>(kPresetNames, name); }
twin::Fidelity fidelityFromName(const std::string& name) {
  return fromName<twin::Fidelity>(kFidelityNames, name);
}

Scenario readScenario(const fs::path& path, const ImagePath& images) {
  auto file = YamlReader::openFile(path);
  Scenario s;
  s.path = fs::absolute(path).lexically_normal();
  std::ifstream stream(path, std::ios::binary);
  s.text.assign(std::istreambuf_iterator<char>(stream), {});
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  s.name = file.text("name");
  if (s.name.empty() ||
      s.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") !=
          std::string::npos ||
      s.name.front() == '.') {
    file.fault("name", "use letters, digits, '-', '_' and '.': it names the results folder");
  }
  s.title = file.text("title", "");
  s.dieline = fileOf(file, "dieline");
  s.machine = fileOf(file, "machine");
  s.layers = readLayers(file);
  s.selection = readSelection(file.section("select"));
  s.board = readBoard(file.section("board"));
  s.print = readPrint(file.section("print"));
  readBelt(file.section("belt"), s);
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
  auto planner = file.section("planner");
  s.job = readJob(planner, s);
  if (planner.has("gcode")) s.job_gcode = fileOf(planner, "gcode");
  if (planner.has("jump_radius_mm")) {
    s.jump_radius_mm = planner.number("jump_radius_mm", {.min = -1, .max = 1000});
    if (*s.jump_radius_mm < 0.0 && *s.jump_radius_mm != planner::kRadiusOfDrawing)
      planner.fault("jump_radius_mm", "is a radius, 0 for straight jumps, or -1 for that of the drawing");
  }
  s.planner_faults = readPlannerFaults(planner.section("faults"));
  s.provoke = readProvoke(file.section("provoke"), s.belt_speed_mm_s > 0.0 && !s.belt_by_controller);
  if (s.provoke.cause != ProvokeChoice::Cause::kNone &&
      s.firmware.dialog != FirmwareChoice::Dialog::kKerfbench)
    file.fault("provoke", "the safe states are those of the reference controller (dialog: kerfbench)");
  if (s.provoke.cause != ProvokeChoice::Cause::kNone && s.firmware.onRealPins())
    file.fault("provoke",
               "is for emulated releases; on real pins (source: gpio, analyser) nothing is provoked yet");
  s.cameras = readCameraChoice(file.section("cameras"));
  auto checks = file.section("checks");
  s.limits = readLimits(checks);
  s.limits.board_transmission = s.board.transmission;  // As the board's data sheet has it.
  s.calibration_max_age_days = static_cast<int>(
      checks.integer("calibration_max_age_days", {.min = 0, .max = 36500, .fallback = 180.0}));
  s.date = file.text("date", "");
  if (!s.date.empty() && !dayNumber(s.date)) file.fault("date", "is no day like 2026-11-21");
  s.time_limit_s = file.number("time_limit_s", {.min = 0.01, .max = 3600, .fallback = 60.0});
  s.seed = static_cast<std::uint64_t>(file.integer("seed", {.min = 0, .max = 9e15, .fallback = 1.0}));
  s.imperfections = presetFromName(readName(file, "imperfections", kPresetNames));
  s.fidelity = fidelityFromName(readName(file, "twin", kFidelityNames));
  file.finish();
  return s;
}

}  // namespace kerfbench::hil
