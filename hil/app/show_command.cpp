// SPDX-License-Identifier: Apache-2.0
#include "hil/app/show_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "hil/app/drawing_choice.h"
#include "hil/app/film_command.h"
#include "hil/app/filmed_run.h"
#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/base/text.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/file_format.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/drawing/drawing_picture.h"
#include "hil/judge/machine_pictures.h"
#include "hil/machine_file/machine_check.h"
#include "hil/run/machine_film.h"
#include "hil/scenario/case.h"
#include "hil/scene/picture.h"
#include "hil/trace/mcap_records.h"
#include "twin/machine/divergence.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

void complain(const std::string& line) { base::toTerminal(stderr, line + "\n"); }

void save(const twin::Scene& scene, const scene::PictureOptions& picture, const fs::path& path) {
  const auto png = scene::renderPng(scene, picture);
  base::writeFileAtomically(path, {reinterpret_cast<const char*>(png.data()), png.size()});
  base::toTerminal(stdout, path.string() + "\n");
}

// At rest, with a plain sheet as large as the field.
twin::Scene atRest(const twin::MachineDescription& machine) {
  const auto& told = machine.controller;
  twin::SceneContent content;
  content.unit_S_mm = Eigen::AlignedBox2d(Eigen::Vector2d(told.field_min_mm[0], told.field_min_mm[1]),
                                          Eigen::Vector2d(told.field_max_mm[0], told.field_max_mm[1]));
  return twin::sceneOf(machine, twin::WebDescription{}, twin::MachinePose{}, content);
}

int showAtRest(const ShowOptions& options) {
  const machine_file::MachineFile file = machine_file::readMachineFile(options.subject);
  machine_file::refuseUnfit(file);
  const twin::MachineDescription& machine = file.machine;
  scene::PictureOptions picture = pictureOptions(options);
  picture.caption = machine.name + "  at rest";
  save(atRest(machine), picture, options.out.empty() ? fs::path(machine.name + ".png") : options.out);
  return 0;
}

// The name for one of several times.
fs::path nameAt(const fs::path& out, double time_s, bool several) {
  if (!several) return out;
  return out.parent_path() /
         fmt::format("{}-{:.4f}s{}", out.stem().string(), time_s, out.extension().string());
}

int showScenario(const ShowOptions& options) {
  scenario::Case test_case = scenario::readCase(options.scenario, options.bin_dir.parent_path() / "firmware");
  if (!options.subject.empty() &&
      fs::weakly_canonical(options.subject) != fs::weakly_canonical(test_case.scenario.machine)) {
    complain(fmt::format("show: {} runs on {}, not on {}", options.scenario.string(),
                         test_case.scenario.machine.string(), options.subject.string()));
    return base::kExitUsage;
  }
  const twin::SampledMachine sampled = scenario::sampledMachine(test_case);
  std::vector<double> times_s = options.at_s;
  std::optional<double> until_s;
  if (!times_s.empty()) until_s = std::ranges::max(times_s);
  base::Console console(options.quiet);
  const run::MachineFilm film = filmedRun(test_case, sampled, until_s, options.bin_dir, console);
  if (times_s.empty()) times_s.push_back(film.middleOfLongestCut_s());
  const fs::path out = options.out.empty() ? fs::path(test_case.scenario.name + ".png") : options.out;
  for (const double time_s : times_s) {
    if (time_s > film.end_s() + 1e-9) {
      complain(fmt::format("show: the run ended at {:.4f} s; shown is its end instead of {:g} s",
                           film.end_s(), time_s));
    }
    save(film.sceneAt(time_s, sampled.machine, scenario::webOn(sampled.machine, test_case),
                      judge::unitOf(*test_case.dieline)),
         pictureOptions(options), nameAt(out, time_s, times_s.size() > 1));
  }
  return 0;
}

int drawDrawing(const ShowOptions& options) {
  const fs::path out = options.out.empty() ? options.subject.stem().replace_extension(".svg") : options.out;
  const std::string kind = base::lowered(out.extension().string());
  if (kind != ".svg" && kind != ".png") {
    complain(fmt::format("show: a drawing is shown as .svg or .png, not as {}", out.string()));
    return base::kExitUsage;
  }
  base::Console console(options.quiet);
  DrawingRules rules =
      drawingRules({options.drawing, options.scenario, {}}, {options.bin_dir.parent_path() / "firmware", {}});
  rules.options.progress = base::progressOn(console);
  const dieline::Dieline dieline = dieline::readDieline(options.subject, rules.options);
  if (dieline.entities.empty()) {
    complain(fmt::format("show: {} has no line to show", options.subject.string()));
    return base::kExitInput;
  }
  const drawing::PictureContent content =
      drawing::contentOf(dieline, options.subject.filename().string(), options.width_px, rules.accepted,
                         base::progressOn(console));
  if (kind == ".svg") {
    base::writeFileAtomically(out, drawing::svgOf(dieline, content));
  } else {
    const auto png = drawing::pngOf(dieline, content);
    base::writeFileAtomically(out, {reinterpret_cast<const char*>(png.data()), png.size()});
  }
  console.result(out.string());
  return 0;
}

int showDrawing(const ShowOptions& options) {
  if (!options.at_s.empty() || options.view != "overall") {
    complain("show: --at and --view are for machines");
    return base::kExitUsage;
  }
  try {
    return drawDrawing(options);
  } catch (const dieline::DielineError& e) {
    complain(e.what());
  } catch (const base::ConfigError& e) {
    complain(e.what());
  } catch (const std::invalid_argument& e) {
    complain(fmt::format("show: {}: {}", options.subject.string(), e.what()));
  }
  return base::kExitInput;
}

}  // namespace

int showCommand(const ShowOptions& options) {
  if (options.subject.empty() && options.scenario.empty()) {
    complain("show: name a machine or a drawing, or --scenario (show --help)");
    return base::kExitUsage;
  }
  if (dieline::fileFormatOf(options.subject) && options.film.empty()) return showDrawing(options);
  if (!options.drawing.empty()) {
    complain("show: --unit, --scale, --turn, --shift and --layer are for drawings");
    return base::kExitUsage;
  }
  if (!std::ranges::all_of(options.at_s, [](double time_s) { return std::isfinite(time_s); })) {
    complain("show: --at takes seconds");
    return base::kExitUsage;
  }
  if (options.film.empty() && !scene::povrayFound()) {
    complain("show: pictures need POV-Ray: install it (apt-get install povray)");
    return base::kExitBroken;
  }
  try {
    if (!options.film.empty()) return showFilm(options);
    return options.scenario.empty() ? showAtRest(options) : showScenario(options);
  } catch (const base::ConfigError& e) {
    complain(e.what());
  } catch (const dieline::DielineError& e) {
    complain(e.what());
  } catch (const planner::PlanError& e) {
    complain(fmt::format("the job cannot be planned: {}", e.what()));
  } catch (const base::InputError& e) {
    complain(e.what());
  } catch (const trace::McapError& e) {
    complain(fmt::format("show: {}", e.what()));
  } catch (const scene::PictureError& e) {
    complain(fmt::format("show: {}", e.what()));
    return base::kExitBroken;
  } catch (const twin::DivergenceError& e) {
    complain(fmt::format("show: {}", e.what()));
    return base::kExitBroken;
  }
  return base::kExitInput;
}

}  // namespace kerfbench::app
