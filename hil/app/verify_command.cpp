// SPDX-License-Identifier: Apache-2.0
#include "hil/app/verify_command.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/app/run_command.h"
#include "hil/base/console.h"
#include "hil/base/digest.h"
#include "hil/base/exit_codes.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/cli/run_guarded.h"
#include "hil/history/run_history.h"
#include "hil/judge/results_folder.h"
#include "hil/judge/results_list.h"
#include "hil/scenario/scenario.h"
#include "hil/source/vcd.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kExitDiffers = 1;
constexpr std::size_t kMaxPlaces = 10;

/// Empty for a file that is not there: the list of the folder tells.
std::string textOf(const fs::path& path) { return base::fileContent(path).value_or(""); }

Json verdictOf(const fs::path& folder) {
  const fs::path path = folder / "verdict.json";
  Json verdict = Json::parse(textOf(path), nullptr, false);
  if (!verdict.is_object()) throw base::InputError(fmt::format("{}: is no verdict", path.string()));
  return verdict;
}

/// A text of a verdict; empty if there is none.
std::string textIn(const Json& verdict, const char* pointer) {
  const Json::json_pointer at(pointer);
  return verdict.contains(at) && verdict.at(at).is_string() ? verdict.at(at).get<std::string>() : "";
}

/// Sums in a list of a verdict whose entries have this name, or all.
std::vector<std::string> sumsIn(const Json& verdict, const char* list, const std::string& name = {}) {
  std::vector<std::string> sums;
  for (const Json& entry : verdict.value(list, Json::array())) {
    if (name.empty() || textIn(entry, "/name") == name) sums.push_back(textIn(entry, "/sha256"));
  }
  return sums;
}

/// What the files of a folder say of each other.
std::vector<std::string> contradictionsIn(const fs::path& folder, const Json& verdict,
                                          const std::optional<std::string>& digest) {
  std::vector<std::string> found;
  if (!fs::is_regular_file(folder / "pins.vcd"))
    return {"pins.vcd is not there, so nothing can be judged again"};
  const std::optional<std::string> sum = source::vcdSum(folder / "pins.vcd");
  if (!sum) found.emplace_back("pins.vcd does not end with a sum that fits it");
  if (sum && sumsIn(verdict, "evidence", "pins") != std::vector{*sum})
    found.emplace_back("verdict.json was given on other pins than those of pins.vcd");
  const std::vector<std::string> inputs = sumsIn(verdict, "inputs");
  if (std::ranges::find(inputs, base::sha256(textOf(folder / "scenario.yaml"))) == inputs.end())
    found.emplace_back("verdict.json was given on another scenario than scenario.yaml");
  if (digest && *digest != textIn(verdict, "/digest"))
    found.push_back(fmt::format("the digest is {}, not {}", textIn(verdict, "/digest"), *digest));
  return found;
}

/// What a replay cannot know: who made the pins, and how it was asked to.
Json withoutOrigin(Json verdict) {
  for (const char* field : {"firmware", "source", "serial_number", "repeat_command"}) verdict.erase(field);
  if (!verdict.contains("versions") || !verdict["versions"].is_object()) return verdict;
  for (const char* version : {"firmware sha256", "controller", "firmware's words"})
    verdict["versions"].erase(version);
  return verdict;
}

std::vector<std::string> linesWithoutOrigin(const std::string& junit) {
  std::vector<std::string> lines;
  std::istringstream text(junit);
  for (std::string line; std::getline(text, line);) {
    const bool is_origin = line.find("<property name=\"firmware\"") != std::string::npos ||
                           line.find("<property name=\"serial_number\"") != std::string::npos ||
                           line.find("<property name=\"repeat_command\"") != std::string::npos;
    if (!is_origin) lines.push_back(line);
  }
  return lines;
}

/// Where two verdicts differ, as JSON pointers.
std::string placesOf(const Json& differences) {
  std::string places;
  for (std::size_t i = 0; i < std::min(differences.size(), kMaxPlaces); ++i)
    places += (places.empty() ? "" : ", ") + textIn(differences[i], "/path").substr(1);
  return differences.size() <= kMaxPlaces
             ? places
             : fmt::format("{} and {} more", places, differences.size() - kMaxPlaces);
}

/// Options of the run that a verdict is of, as far as it states them; what it states wrongly differs then.
judge::RunOptions optionsOf(const Json& verdict, judge::RunOptions run) {
  if (verdict.contains("seed") && verdict["seed"].is_number_unsigned()) run.seed = verdict["seed"];
  const auto stated = [&verdict](const char* pointer, const auto& names) -> std::optional<std::string> {
    const std::string name = textIn(verdict, pointer);
    if (std::ranges::find(names, name) == names.end()) return std::nullopt;
    return name;
  };
  run.twin = stated("/model/twin", scenario::kFidelityNames);
  run.imperfections = stated("/model/imperfections", scenario::kPresetNames);
  run.pictures = false;
  return run;
}

/// What differs between a folder and what its pins give when they are judged again, as then.
std::vector<std::string> replayDifferences(const VerifyOptions& options, const Json& verdict) {
  // Never committed: it is a scratch folder that goes with the object.
  const judge::ResultsFolder scratch(fs::temp_directory_path(), "kerfbench-verify");
  judge::RunOptions run = optionsOf(verdict, options.run);
  run.results_dir = scratch.staging();
  const int code =
      replayCommand({options.folder / "pins.vcd", options.scenario, options.image, options.frames}, run);
  if (code == base::kExitInput || code == base::kExitBroken)
    throw base::InputError(fmt::format("{}: its pins could not be judged again", options.folder.string()));
  const fs::path again = history::runMeantBy(fs::directory_iterator(scratch.staging())->path());
  const Json now = verdictOf(again);
  std::vector<std::string> found;
  if (sumsIn(verdict, "inputs") != sumsIn(now, "inputs"))
    found.emplace_back("the scenario, or a file that it names, is not what the verdict was given on");
  if (const Json differences = Json::diff(withoutOrigin(verdict), withoutOrigin(now)); !differences.empty())
    found.push_back("verdict.json is not what its pins give: " + placesOf(differences));
  if (linesWithoutOrigin(textOf(options.folder / "junit.xml")) !=
      linesWithoutOrigin(textOf(again / "junit.xml")))
    found.emplace_back("junit.xml is not what its pins give");
  return found;
}

int verify(const VerifyOptions& options) {
  base::Console console(options.run.quiet);
  std::size_t count = 0;
  // At once: what follows may be refused.
  const auto tell = [&](const std::vector<std::string>& differences) {
    for (const std::string& difference : differences) console.result("  " + difference);
    count += differences.size();
  };
  tell(judge::changedSinceListed(options.folder));
  const Json verdict = verdictOf(options.folder);
  tell(contradictionsIn(options.folder, verdict, options.digest));
  if (!options.scenario.empty() && fs::is_regular_file(options.folder / "pins.vcd"))
    tell(replayDifferences(options, verdict));
  const char* const extent = options.scenario.empty()
                                 ? "its sums fit; its pins were not judged again (--scenario)"
                                 : "its sums fit, and its pins give its verdict";
  console.result(fmt::format("{}: {}", options.folder.string(),
                             count == 0 ? std::string(extent)
                                        : fmt::format("not what a run wrote: {} thing{}", count,
                                                      count == 1 ? " differs" : "s differ")));
  return count == 0 ? 0 : kExitDiffers;
}

}  // namespace

int verifyCommand(const VerifyOptions& options) {
  return cli::runGuarded(options.folder, [&] {
    // The runs of a scenario: the latest of them.
    VerifyOptions of_run = options;
    if (history::holdsRuns(options.folder)) of_run.folder = history::runMeantBy(options.folder);
    return verify(of_run);
  });
}

}  // namespace kerfbench::app
