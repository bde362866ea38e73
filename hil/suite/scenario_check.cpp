// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/scenario_check.h"

#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/temporary.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"
#include "hil/run/controller_fit.h"
#include "hil/scenario/case.h"
#include "hil/suite/image_fit.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;

/// A text that YAML reads as it is: JSON's strings are a part of YAML.
std::string yamlText(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The lines of a message without "FILE:LINE: checks." before them; nothing where a line has another file.
std::string withoutPlace(const std::string& message, const fs::path& file) {
  std::istringstream lines(message);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = file.string() + ":";
    const std::size_t end = line.starts_with(place) ? line.find(": ", place.size()) : std::string::npos;
    if (end == std::string::npos) return {};
    std::string what = line.substr(end + 2);
    if (what.starts_with("checks.")) what.erase(0, 7);
    text += (text.empty() ? "" : "\n") + what;
  }
  return text;
}

}  // namespace

std::string limitedScenario(const fs::path& scenario, const std::map<std::string, std::string>& limits) {
  std::string text = fmt::format("extends: {}\n", yamlText(scenario.string()));
  if (limits.empty()) return text;
  text += "checks:\n";
  // Keys are sorted, so those of a section follow each other.
  std::vector<std::string> open;
  for (const auto& [key, value] : limits) {
    std::vector<std::string> path;
    std::istringstream parts(key);
    for (std::string part; std::getline(parts, part, '.');) path.push_back(part);
    std::size_t depth = 0;
    while (depth < open.size() && depth + 1 < path.size() && open[depth] == path[depth]) ++depth;
    open.resize(depth);
    for (; depth + 1 < path.size(); ++depth) {
      text += fmt::format("{}{}:\n", std::string(2 * (depth + 1), ' '), yamlText(path[depth]));
      open.push_back(path[depth]);
    }
    text +=
        fmt::format("{}{}: {}\n", std::string(2 * (depth + 1), ' '), yamlText(path.back()), yamlText(value));
  }
  return text;
}

const ScenarioAnswer& ScenarioChecks::check(const fs::path& scenario, const fs::path& image,
                                            const std::map<std::string, std::string>& limits) {
  const std::string limited = limits.empty() ? std::string() : limitedScenario(scenario, limits);
  const std::string key = fmt::format("{}\n{}\n{}", scenario.string(), image.string(), limited);
  auto found = answers_.find(key);
  if (found == answers_.end()) found = answers_.emplace(key, answerTo(scenario, image, limited)).first;
  return found->second;
}

ScenarioAnswer ScenarioChecks::answerTo(const fs::path& scenario, const fs::path& image,
                                        const std::string& limited) {
  using Fault = ScenarioAnswer::Fault;
  const base::TemporaryFolder folder(fs::temp_directory_path(), "kerfbench-suite");
  fs::path file = scenario;
  if (!limited.empty()) {
    file = folder.path() / "limited.yaml";
    base::writeFileAtomically(file, limited);
  }
  try {
    const scenario::Case test_case = scenario::readCase(file, {bin_dir_.parent_path() / "firmware", image});
    const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
    run::refuseUnfitController(test_case, bin_dir_);
    ScenarioAnswer answer;
    if (!image.empty()) answer.why = whyImageDoesNotFit(firmware, bin_dir_);
    if (!answer.why.empty()) answer.fault = Fault::kImage;
    answer.scenario = {test_case.scenario.name, test_case.scenario.title, firmware.onRealPins(), {}};
    std::vector<fs::path> files = test_case.inputs;
    if (firmware.emulator() != nullptr) files.push_back(firmware.childIn(bin_dir_));
    for (const fs::path& input : files) {
      if (input == file && !limited.empty()) continue;
      auto sum = sums_.find(input);
      if (sum == sums_.end()) sum = sums_.emplace(input, base::sha256File(input)).first;
      answer.scenario.files[input] = sum->second;
    }
    return answer;
  } catch (const base::ConfigError& e) {
    const std::string of_limits = limited.empty() ? std::string() : withoutPlace(e.what(), file);
    if (!of_limits.empty()) return {Fault::kLimits, of_limits, {}};
    return {Fault::kScenario, e.what(), {}};
  } catch (const dieline::DielineError& e) {
    return {Fault::kScenario, e.what(), {}};
  } catch (const std::system_error& e) {
    return {Fault::kScenario, fmt::format("{}:1: {}", scenario.string(), e.what()), {}};
  }
}

}  // namespace kerfbench::suite
