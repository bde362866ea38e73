// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/fold_scenario.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/fold/five_axis_program.h"
#include "hil/fold/fold_program.h"
#include "hil/fold/fold_units.h"

namespace kerfbench::fold {
namespace {

std::string contentOf(const std::filesystem::path& path) {
  return base::inputContent(path, base::kLargestRecord_bytes);
}

twin::BoardDescription readBoard(base::YamlReader section) {
  twin::BoardDescription board;
  board.thickness_mm =
      section.number("thickness_mm", {.min = 0.05, .max = 2, .fallback = board.thickness_mm});
  board.cut_fluence_j_mm2 =
      section.number("cut_fluence_j_mm2", {.min = 0.01, .max = 100, .fallback = board.cut_fluence_j_mm2});
  board.transmission =
      section.number("transmission", {.min = 0.01, .max = 0.5, .fallback = board.transmission});
  return board;
}

inspect::SpaceTolerances readLimits(base::YamlReader section) {
  inspect::SpaceTolerances limits;
  limits.path_mm = section.number("path_mm", {.min = 0.001, .max = 10, .fallback = limits.path_mm});
  limits.burn_mm = section.number("burn_mm", {.min = 0.001, .max = 10, .fallback = limits.burn_mm});
  limits.uncut_mm = section.number("uncut_mm", {.min = 0.1, .max = 100, .fallback = limits.uncut_mm});
  limits.stray_mm = section.number("stray_mm", {.min = 0.1, .max = 100, .fallback = limits.stray_mm});
  return limits;
}

/// The section `program`: a file, or what the planner is asked for.
struct ProgramChoice {
  std::optional<std::filesystem::path> file;
  ProgramOrder order;
};

ProgramChoice readProgram(base::YamlReader section, double kerf_radius_mm, const std::string& side) {
  ProgramChoice choice;
  if (section.has("gcode")) {
    choice.file = section.folderOf("gcode") / section.text("gcode");
    for (const char* key : {"kerf_radius_mm", "side", "joints"}) {
      if (section.has(key)) section.fault(key, "has no effect beside gcode");
    }
    return choice;
  }
  choice.order.kerf_radius_mm =
      section.number("kerf_radius_mm", {.min = 0.01, .max = 5, .fallback = kerf_radius_mm});
  choice.order.left = section.choice("side", {"left", "right"}, side) == "left";
  const std::string joints = section.choice("joints", {"ours", "paper", "uncompensated"}, "ours");
  choice.order.law = joints == "paper"           ? PathLaw::kPaper
                     : joints == "uncompensated" ? PathLaw::kUncompensated
                                                 : PathLaw::kOurs;
  return choice;
}

/// What a scenario says, before what it names is read.
struct Read {
  FoldScenario scenario;
  std::filesystem::path machine, contour;
  double kerf_radius_mm{};
  std::string side;
  ProgramChoice program;
};

/// As of other scenarios: it names a folder.
std::string nameOf(base::YamlReader& file) {
  constexpr const char* kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  constexpr std::size_t kLongest = 100;
  const std::string name = file.text("name");
  if (name.empty() || name.size() > kLongest || name.find_first_not_of(kAllowed) != std::string::npos ||
      name.front() == '.')
    file.fault("name",
               fmt::format("use at most {} letters, digits, '-', '_' and '.': it names the results folder",
                           kLongest));
  return name;
}

Read readFile(base::YamlReader& file) {
  Read read;
  FoldScenario& scenario = read.scenario;
  scenario.path = file.path();
  file.integer("version", {.min = 1, .max = 1});
  scenario.name = nameOf(file);
  scenario.seed = static_cast<std::uint64_t>(file.integer("seed", {.min = 0, .max = 1e9, .fallback = 1.0}));
  read.machine = file.folderOf("machine") / file.text("machine");
  read.contour = file.folderOf("contour") / file.text("contour");
  base::YamlReader kerf = file.section("kerf");
  read.kerf_radius_mm = kerf.number("radius_mm", {.min = 0.05, .max = 0.22});
  read.side = kerf.choice("side", {"left", "right"});
  read.program = readProgram(file.section("program"), read.kerf_radius_mm, read.side);
  scenario.board = readBoard(file.section("board"));
  scenario.print_sigma_mm =
      kMicron_mm * file.number("print_registration_um", {.min = 0.1, .max = 50, .fallback = 2.0});
  scenario.limits = readLimits(file.section("limits"));
  scenario.blank = readBlank(file);
  return read;
}

}  // namespace

FoldScenario readFoldScenario(const std::filesystem::path& path) {
  base::YamlReader file = base::YamlReader::openFile(path);
  Read read = readFile(file);
  FoldScenario& scenario = read.scenario;
  // The keys of `errors` are checked with the others, before the machine is read; its values come after.
  readErrors(file.section("errors"), {});
  file.finish();
  scenario.keys = file.asked();
  scenario.machine = readFoldMachine(read.machine);
  base::YamlReader again = base::YamlReader::openFile(path);
  scenario.machine.head.errors = readErrors(again.section("errors"), scenario.machine.head.errors);
  misprint(scenario.print_sigma_mm, scenario.seed, scenario.blank);

  const std::string contour_name = read.contour.filename().string();
  const std::string contour = contentOf(read.contour);
  scenario.contour = inspect::readContourFile(contour, contour_name);
  scenario.job = inspect::layContour(scenario.contour, scenario.blank.drawn, read.side == "left" ? 1.0 : -1.0,
                                     read.kerf_radius_mm, contour_name);
  if (read.program.file) {
    scenario.program = contentOf(*read.program.file);
    scenario.program_name = read.program.file->filename().string();
    scenario.inputs.push_back(*read.program.file);
  } else {
    scenario.program = plannedProgram(contour, contour_name, read.program.order);
    scenario.program_name = "program.gcode";
  }
  scenario.moves = readFiveAxisProgram(scenario.program, scenario.program_name);
  scenario.inputs.push_back(read.contour);
  for (const auto& inputs : {file.inputs(), scenario.machine.inputs})
    scenario.inputs.insert(scenario.inputs.end(), inputs.begin(), inputs.end());
  return std::move(scenario);
}

}  // namespace kerfbench::fold
