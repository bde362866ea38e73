// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/machine_check.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

void say(const std::string& line) { std::fputs((line + "\n").c_str(), stdout); }

bool isDrawing(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  return extension == ".dxf" || extension == ".svg";
}

// A scenario names a dieline; a machine does not. What it extends counts as well.
bool isScenario(const fs::path& path) {
  const auto file = YamlReader::openFile(path);
  return file.has("dieline") || file.has("firmware");
}

// Returns the number of errors.
int lintDrawing(const fs::path& path, const LayerProfile& layers, bool quiet) {
  const Dieline dieline = readDieline(path, layers);
  int errors = 0;
  for (const LintFinding& finding : lintDieline(dieline)) {
    errors += finding.is_error ? 1 : 0;
    if (quiet && !finding.is_error) continue;
    say(fmt::format("{}: {} at ({:.3f}, {:.3f}) mm, layer {}: {}", path.string(),
                    finding.is_error ? "error" : "warning", finding.p_mm.x(), finding.p_mm.y(),
                    finding.layer.empty() ? "-" : finding.layer, finding.message));
  }
  if (!quiet) {
    const auto box = dieline.bounds();
    if (!box.isEmpty()) {
      say(fmt::format("{}: {} entities, {:.2f} x {:.2f} mm", path.string(), dieline.entities.size(),
                      box.sizes().x(), box.sizes().y()));
    }
  }
  return errors;
}

int lintFile(const fs::path& path, const CommonOptions& options) {
  if (isDrawing(path)) return lintDrawing(path, defaultLayerProfile(), options.quiet);
  if (isScenario(path)) {
    Case the_case;
    the_case.scenario = readScenario(path, {options.bin_dir.parent_path() / "firmware"});
    const MachineFile file = readMachineFile(the_case.scenario.machine);
    the_case.machine = file.machine;
    refuseUnfit(file, webOf(the_case));
    return lintDrawing(the_case.scenario.dieline, the_case.scenario.layers, options.quiet);
  }
  refuseUnfit(readMachineFile(path));
  return 0;
}

}  // namespace

int lintCommand(const std::vector<fs::path>& files, const CommonOptions& options) {
  int errors = 0;
  for (const fs::path& path : files) {
    try {
      const int found = lintFile(path, options);
      if (found == 0 && !options.quiet) say(fmt::format("{}: good", path.string()));
      errors += found;
    } catch (const ConfigError& e) {
      std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
      ++errors;
    } catch (const DielineError& e) {
      std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
      ++errors;
    }
  }
  return errors == 0 ? 0 : kExitInput;
}

}  // namespace kerfbench::hil
