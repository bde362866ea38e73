// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/first_scenario.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/plan.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/base/yaml_reader.h"
#include "hil/desk/file_name.h"
#include "hil/desk/job_case.h"
#include "hil/desk/sheet_place.h"
#include "hil/desk/yaml_words.h"
#include "hil/dieline/file_format.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/dieline/remarks.h"
#include "hil/machine_file/machine_file.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using dieline::Process;

/// As the shipped scenarios have it: so much of the energy that just cuts through on the axis of the beam.
constexpr double kEnergySurplus = 1.6;
constexpr double kCutFluence_j_mm2 = 0.5;
/// Most of the laser's power that marks ask for: the rest is for what a run adds.
constexpr double kPowerShare = 0.8;
/// The usual release must make so much of the usual 300 mm/s.
constexpr double kSlowestUsual_mm_s = 150.0;
/// How often the speeds are halved until the job fits.
constexpr int kMostTries = 5;

/// A drawing as it can be read, and what has to be said for that.
struct ReadDrawing {
  dieline::Dieline dieline;
  std::string unit;  ///< Empty: the file says it.
};

ReadDrawing readAnyLayers(const fs::path& file, const base::ProgressFn& progress) {
  dieline::DrawingOptions options;
  options.layers = {"all", {}};
  options.layers.styled["*"].other = Process::kCut;
  options.progress = progress;
  try {
    return {dieline::readDieline(file, options), ""};
  } catch (const dieline::DielineError&) {
    options.unit = dieline::DrawingUnit::kMillimetre;
    try {
      return {dieline::readDieline(file, options), "mm"};
    } catch (const dieline::DielineError&) {
    }
    throw;
  }
}

void refuseEmpty(const fs::path& file, const dieline::Dieline& drawing) {
  if (!drawing.bounds().isEmpty()) return;
  std::string why;
  for (const dieline::Remark& remark : dieline::remarksOf(drawing))
    if (remark.line > 0) why += fmt::format("\n{}:{}: {}", file.string(), remark.line, remark.message);
  throw base::InputError(fmt::format("{}: it holds no line that could be cut{}", file.string(), why));
}

/// A layer, what it is taken for, and whether that is a guess.
struct LayerGuess {
  std::string name;
  Process process{Process::kIgnore};
  bool is_guessed{};
};

std::vector<LayerGuess> guessedLayers(const dieline::Dieline& drawing) {
  std::map<std::string, double> lengths;
  for (const dieline::Entity& entity : drawing.entities)
    lengths[entity.layer] += dieline::lengthOf(entity.curve);
  const dieline::LayerProfile usual = dieline::defaultLayerProfile();
  std::vector<LayerGuess> layers;
  bool has_work = false;
  for (const auto& [name, length_mm] : lengths) {
    const std::optional<Process> process = dieline::processFor(usual, name);
    layers.push_back({name, process.value_or(Process::kIgnore), !process.has_value()});
    has_work = has_work || layers.back().process != Process::kIgnore;
  }
  if (has_work || layers.empty()) return layers;
  // A drawing with nothing to cut is none: the layer with most in it.
  auto most = layers.begin();
  for (auto it = layers.begin(); it != layers.end(); ++it)
    if (it->is_guessed && (!most->is_guessed || lengths[it->name] > lengths[most->name])) most = it;
  if (most->is_guessed) most->process = Process::kCut;
  return layers;
}

/// Whether the rules are read as they are; if not, lines of a layer differ by colour or linetype.
bool areReadAsTheyAre(const fs::path& file, const std::string& unit, const std::vector<LayerGuess>& layers) {
  dieline::DrawingOptions options;
  options.layers = {"guessed", {}};
  for (const LayerGuess& layer : layers) options.layers.rules[layer.name] = layer.process;
  options.unit = dieline::drawingUnitFromName(unit);
  try {
    (void)dieline::readDieline(file, options);
    return true;
  } catch (const dieline::DielineError&) {
    return false;
  }
}

/// Letters of a name that a results folder may have.
std::string folderName(const fs::path& file) {
  std::string name;
  for (const char c : file.stem().string())
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' ? c : '-';
  return name.empty() || name.front() == '.' ? "job" + name : name;
}

/// Writes the scenario; the speeds may be tried several times.
class ScenarioWriter {
 public:
  ScenarioWriter(const NewScenario& wish, const DeskRequest& request)
      : wish_(wish),
        drawing_(readAnyLayers(wish.drawing, request.progress)),
        machine_(machine_file::readMachineFile(wish.machine).machine),
        layers_(guessedLayers(drawing_.dieline)) {
    has_plain_rules_ = areReadAsTheyAre(wish.drawing, drawing_.unit, layers_);
    std::map<std::string, Process> processes;
    for (const LayerGuess& layer : layers_) processes[layer.name] = layer.process;
    for (dieline::Entity& entity : drawing_.dieline.entities) entity.process = processes[entity.layer];
    box_ = drawing_.dieline.bounds();
    refuseEmpty(wish.drawing, drawing_.dieline);
    const auto& told = machine_.controller;
    field_ = Eigen::AlignedBox2d(Eigen::Vector2d(told.field_min_mm[0], told.field_min_mm[1]),
                                 Eigen::Vector2d(told.field_max_mm[0], told.field_max_mm[1]));
    place_ = placeOnSheet(box_, field_);
    energy_j_mm_ = kEnergySurplus * kCutFluence_j_mm2 * machine_.beam.waist_radius_mm *
                   std::sqrt(0.5 * std::numbers::pi);
  }

  [[nodiscard]] std::string text(double share) const {
    return head() + layers() + sheet() + firmware() + planner(share) +
           "\nchecks: {path_mm: 0.05, stillness_mm: 0.05}   # Limits: how far the cut may lie from the "
           "drawing, "
           "and the beam from where it should be.\ntime_limit_s: 300\n";
  }

 private:
  [[nodiscard]] bool isGantry() const { return machine_.kind == twin::MachineDescription::Kind::kGantry; }

  [[nodiscard]] std::string head() const {
    const fs::path folder = wish_.out.parent_path();
    std::string text = fmt::format(
        "# A first scenario for {} on {}: all that one may want to change has a word on it.\n"
        "version: 1\nname: {}\ntitle: {}\n",
        base::printable(wish_.drawing.filename().string(), 120), base::printable(machine_.name),
        yamlScalar(folderName(wish_.out)),
        yamlScalar(fmt::format("{}, {:.1f} x {:.1f} mm, on {}",
                               base::printable(wish_.drawing.filename().string(), 120), box_.sizes().x(),
                               box_.sizes().y(), base::printable(machine_.name))));
    const std::string file = yamlScalar(nameFromFolder(wish_.drawing, folder));
    if (drawing_.unit.empty() && place_.shift_y_mm == 0.0) {
      text += fmt::format("dieline: {}\n", file);
    } else {
      text += fmt::format("dieline:\n  file: {}\n", file);
      if (!drawing_.unit.empty())
        text += fmt::format("  unit: {}   # The file does not say what its unit is: look at the size.\n",
                            drawing_.unit);
      if (place_.shift_y_mm != 0.0)
        text += fmt::format("  shift: [0, {}]   # Into the middle of the field across the web.\n",
                            place_.shift_y_mm);
    }
    if ((box_.sizes().array() > field_.sizes().array()).any()) {
      text += fmt::format("# The drawing is {:.1f} x {:.1f} mm, the field of the beam {:g} x {:g} mm.\n",
                          box_.sizes().x(), box_.sizes().y(), field_.sizes().x(), field_.sizes().y());
    }
    return text + fmt::format("machine: {}\n", yamlScalar(nameFromFolder(wish_.machine, folder)));
  }

  [[nodiscard]] std::string layers() const {
    const bool all_usual = std::ranges::none_of(layers_, &LayerGuess::is_guessed);
    if (all_usual && has_plain_rules_) return {};
    std::string text = "layers:   # Each is cut, half-cut, crease, perforation or ignore.\n";
    for (const LayerGuess& layer : layers_) {
      const std::string process(dieline::processName(layer.process));
      text += fmt::format("  {}: {}{}\n", yamlScalar(layer.name),
                          has_plain_rules_ ? process : "{other: " + process + "}",
                          layer.is_guessed ? "   # No usual name: say what it is for." : "");
    }
    return text;
  }

  /// Five registration marks round the drawing; the fifth tells a sheet that is turned round.
  [[nodiscard]] std::string sheet() const {
    std::string text =
        "\nboard:\n  thickness_mm: 0.4\n"
        "  cut_fluence_j_mm2: 0.5   # Energy per area that just cuts through.\n"
        "  transmission: 0.12       # Of the inspection table's back light through uncut board.\n"
        "\nprint:\n  units: 1\n";
    text += fmt::format(
        "  pitch_mm: {:g}\n  marks:   # Registration marks beside the drawing: where the print has them.\n",
        place_.pitch_mm);
    for (const Eigen::Vector2d& p : place_.marks_mm)
      text += fmt::format("    - {{x_mm: {:g}, y_mm: {:g}, diameter_mm: {:g}}}\n", p.x(), p.y(),
                          kMarkDiameter_mm);
    return text + fmt::format(
                      "\nbelt:\n  speed_mm_s: 0      # The sheet lies at rest; a speed makes it a web that "
                      "never stops,\n"
                      "  start_x_mm: {}  # and takes this away: the drawing is in the middle of the field.\n",
                      place_.start_x_mm);
  }

  /// Whether the usual release, with 31 steps of an axis in 0.8 ms, would be too slow for such mirrors.
  [[nodiscard]] bool hasFineSteps() const {
    const auto& told = machine_.controller;
    const double arm_mm = told.focal_length_mm > 0.0 ? told.focal_length_mm : told.throw_mm;
    const planner::Target usual;
    return !isGantry() &&
           usual.max_steps * 2.0 * told.mirror_step_rad * arm_mm / usual.periodS() < kSlowestUsual_mm_s;
  }

  /// A release for the controller that the machine's pins are of.
  [[nodiscard]] std::string firmware() const {
    auto file = base::YamlReader::openFile(wish_.machine);
    base::YamlReader pins = file.section("pins");
    bool is_8051 = false, is_stm32 = false;
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const std::string pin = pins.text(signalName(static_cast<Signal>(i)), "");
      is_8051 = is_8051 || pin.find('.') != std::string::npos;
      // PA0 has two digits on an STM32 alone: its ports have sixteen bits.
      is_stm32 = is_stm32 || (!is_8051 && pin.size() == 4);
    }
    std::string release = "{source: native, image: controller-native, mcu: native}";
    if (hasFineSteps())
      release = "{source: native, image: controller-native-galvo, mcu: native, baud: 2000000}";
    if (is_8051)
      release =
          "{source: mcs51, image: controller-mcs51.hex, mcu: stc15w4k32s4, clock_hz: 24000000, baud: 125000}";
    if (is_stm32) release = "{source: cortex_m, image: controller-stm32.hex}";
    return "\n# The reference release; yours: {source: avr, image: my-release.hex, mcu: "
           "atmega2560}.\nfirmware: " +
           release + "\n";
  }

  [[nodiscard]] std::string planner(double share) const {
    const double by_power = kPowerShare * machine_.controller.full_power_w / energy_j_mm_;
    const auto speed = [&](double usual) {
      return std::max(1.0, std::floor(share * std::min(usual, by_power)));
    };
    const double acceleration = (isGantry() ? 2500.0 : 20000.0) * share;
    return fmt::format(
        "\nplanner:\n  mark_speed_mm_s: {:g}\n  jump_speed_mm_s: {:g}\n  acceleration_mm_s2: {:g}\n"
        "  cut_energy_j_per_mm: {:.3g}   # 1.6 times what just cuts through on the axis of the beam.\n"
        "  order: shortest   # Or nearest, drawn, or a list of entities: [3, 0, 5-8].\n",
        speed(isGantry() ? 230.0 : 300.0), std::max(1.0, std::floor(share * (isGantry() ? 400.0 : 450.0))),
        acceleration, energy_j_mm_);
  }

  const NewScenario& wish_;
  ReadDrawing drawing_;
  twin::MachineDescription machine_;
  std::vector<LayerGuess> layers_;
  bool has_plain_rules_{true};
  Eigen::AlignedBox2d box_, field_;
  SheetPlace place_;
  double energy_j_mm_{};
};

/// Whether slower could help: the text is a case that the planner has a plan for, or not even a case.
bool isAsFastAsItMay(const std::string& text, const fs::path& out, const DeskRequest& request) {
  const JobCase found = jobCaseOf({text, out}, false, request);
  if (!found.test_case) return true;
  try {
    (void)planner::plan(*found.test_case->dieline, scenario::targetedMachine(*found.test_case),
                        scenario::plannerJob(*found.test_case));
    return true;
  } catch (const planner::PlanError&) {
    return false;
  }
}

}  // namespace

void refuseUncuttable(const fs::path& drawing, const DeskRequest& request) {
  if (dieline::fileFormatOf(drawing)) refuseEmpty(drawing, readAnyLayers(drawing, request.progress).dieline);
}

std::string firstScenario(const NewScenario& wish, const DeskRequest& request) {
  const ScenarioWriter writer(wish, request);
  const std::string fastest = writer.text(1.0);
  double share = 1.0;
  for (int i = 0; i < kMostTries; ++i, share *= 0.5) {
    std::string text = writer.text(share);
    if (isAsFastAsItMay(text, wish.out, request)) return text;
  }
  return fastest;  // Slower does not help: a check tells what is wrong.
}

}  // namespace kerfbench::desk
