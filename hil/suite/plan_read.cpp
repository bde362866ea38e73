// SPDX-License-Identifier: Apache-2.0
#include <glob.h>

#include <algorithm>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/config_text.h"
#include "hil/base/number_from.h"
#include "hil/base/text.h"
#include "hil/base/yaml_reader.h"
#include "hil/inspect/check_names.h"
#include "hil/scenario/scenario.h"
#include "hil/suite/plan.h"
#include "hil/suite/scenario_check.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using base::YamlReader;

constexpr std::size_t kMostRuns = 10'000;
constexpr std::uint64_t kLargestSeed = 9'000'000'000'000'000;  // As in scenarios.

bool isName(const std::string& name) {
  constexpr const char* kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  return !name.empty() && name.front() != '.' && name.find_first_not_of(kAllowed) == std::string::npos;
}

/// Files that a pattern matches, sorted by name. Characters of patterns in `folder` stand for themselves.
std::vector<fs::path> filesOf(const fs::path& folder, const std::string& pattern) {
  std::string whole;
  for (const char c : folder.string())
    whole += (std::string_view("*?[\\").find(c) != std::string_view::npos ? "\\" : "") + std::string(1, c);
  if (fs::path(pattern).is_absolute()) whole.clear();
  glob_t found{};
  std::vector<fs::path> files;
  if (::glob((whole.empty() ? pattern : whole + "/" + pattern).c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i)
      files.emplace_back(fs::path(found.gl_pathv[i]).lexically_normal());
  }
  ::globfree(&found);
  return files;
}

/// What an entry says, or the plan's `defaults`.
struct Choices {
  RunChoices of_all;
  std::vector<std::uint64_t> seeds;
  std::vector<std::string> tags;
  fs::path image;
};

/// Reads a plan; what is wrong is collected in the reader and in the lines of scenarios.
class PlanReader {
 public:
  PlanReader(const fs::path& path, const PlanSurroundings& surroundings)
      : PlanReader(path, base::configText(path), surroundings) {}

  Plan read() {
    if (file_.integer("version", {.min = 1, .max = 1e6}) != 1)
      file_.fault("version", "this program reads version 1");
    plan_.name = file_.text("name");
    if (!isName(plan_.name))
      file_.fault("name", "use letters, digits, '-', '_' and '.': it names the results folder");
    plan_.title = file_.text("title", "");
    plan_.stop_after =
        static_cast<std::size_t>(file_.integer("stop_after", {.min = 0, .max = 1e6, .fallback = 0.0}));
    YamlReader defaults = file_.section("defaults");
    const Choices usual = readChoices(defaults, {});
    std::vector<YamlReader> entries = file_.list("runs");
    if (entries.empty()) file_.fault("runs", "a plan has at least one run");
    for (std::size_t i = 0; i < entries.size(); ++i)
      addEntry(entries[i], usual, file_.placeOf(fmt::format("runs[{}].scenario", i)));
    plan_.keys = file_.asked();
    refuse();
    return std::move(plan_);
  }

 private:
  PlanReader(const fs::path& path, std::string text, const PlanSurroundings& surroundings)
      : file_(YamlReader::openText(path, text)), surroundings_(surroundings), checks_(surroundings.bin_dir) {
    plan_.path = fs::absolute(path).lexically_normal();
    plan_.text = std::move(text);
  }

  void refuse() {
    std::string faults;
    try {
      file_.finish();
    } catch (const base::ConfigError& e) {
      faults = e.what();
    }
    for (const std::string& line : scenario_faults_) faults += (faults.empty() ? "" : "\n") + line;
    if (!faults.empty()) throw base::ConfigError(faults);
  }

  static std::vector<std::uint64_t> readSeeds(YamlReader& from) {
    std::vector<std::uint64_t> seeds;
    for (const std::string& text : from.texts("seeds")) {
      const auto seed = base::numberFrom<std::uint64_t>(text);
      if (!seed || *seed > kLargestSeed) {
        from.fault("seeds",
                   fmt::format("{} is no whole number from 0 to {}", base::inQuotes(text), kLargestSeed));
      } else if (std::ranges::find(seeds, *seed) != seeds.end()) {
        from.fault("seeds", fmt::format("{} is given twice", *seed));
      } else {
        seeds.push_back(*seed);
      }
    }
    return seeds;
  }

  template <std::size_t n>
  static std::optional<std::string> readName(YamlReader& from, std::string_view key,
                                             const std::array<const char*, n>& names,
                                             std::optional<std::string> usual) {
    if (!from.has(key)) return usual;
    return from.choice(key, {names.begin(), names.end()});
  }

  static fs::path readImage(YamlReader& from, const fs::path& usual, const fs::path& firmware_dir) {
    if (!from.has("image")) return usual;
    const std::string name = from.text("image");
    for (const fs::path& folder : {from.folderOf("image"), firmware_dir}) {
      const fs::path candidate = fs::absolute(folder / name).lexically_normal();
      if (fs::is_regular_file(candidate)) return candidate;
    }
    from.fault("image", fmt::format("no such file {} (looked beside the plan and in {})",
                                    base::inQuotes(name), firmware_dir.string()));
    return usual;
  }

  Choices readChoices(YamlReader& from, const Choices& usual) const {
    Choices c = usual;
    c.of_all.imperfections =
        readName(from, "imperfections", scenario::kPresetNames, usual.of_all.imperfections);
    c.of_all.twin = readName(from, "twin", scenario::kFidelityNames, usual.of_all.twin);
    if (from.has("time_limit_s"))
      c.of_all.time_limit_s = from.number("time_limit_s", {.min = 0.01, .max = 3600});
    if (from.has("seeds")) c.seeds = readSeeds(from);
    for (const auto& [path, value] : from.leaves("limits"))
      c.of_all.limits[fmt::format("{}", fmt::join(path, "."))] = value;
    for (std::string& tag : from.texts("tags")) c.tags.push_back(std::move(tag));
    std::ranges::sort(c.tags);
    c.tags.erase(std::unique(c.tags.begin(), c.tags.end()), c.tags.end());
    c.image = readImage(from, usual.image, surroundings_.bin_dir.parent_path() / "firmware");
    return c;
  }

  static Expectation readExpectation(YamlReader& entry) {
    Expectation expect;
    expect.verdict = entry.choice("expect", {"PASS", "FAIL", "NOT PROVEN", "INVALID"}, "PASS");
    expect.by = entry.texts("by");
    for (const std::string& name : expect.by) {
      if (std::ranges::find(inspect::kCheckNames, name) == inspect::kCheckNames.end())
        entry.fault("by", fmt::format("{} is no check; there are {}", base::inQuotes(name),
                                      fmt::join(inspect::kCheckNames, ", ")));
    }
    if (expect.isPass() && !expect.by.empty()) entry.fault("by", "is for runs that are expected not to PASS");
    if (expect.verdict == "FAIL" && expect.by.empty())
      entry.fault("by", "missing: name the checks that must FAIL, or any other would do");
    return expect;
  }

  void addEntry(YamlReader& entry, const Choices& usual, const std::string& place) {
    const Choices choices = readChoices(entry, usual);
    const std::string name = entry.text("name", "");
    if (entry.has("name") && !isName(name)) entry.fault("name", "use letters, digits, '-', '_' and '.'");
    PlannedRun run;
    run.place = place;
    run.expect = readExpectation(entry);
    run.takes_release = entry.boolean("takes_release", run.expect.isPass());
    run.tags = choices.tags;
    run.choices = choices.of_all;
    run.image = choices.image;
    const bool is_replaced = run.takes_release && !surroundings_.image.empty();
    if (is_replaced) run.image = fs::absolute(surroundings_.image).lexically_normal();
    run.takes_release = is_replaced;
    const std::vector<std::string> patterns =
        entry.isList("scenario") ? entry.texts("scenario") : std::vector{entry.text("scenario")};
    for (const std::string& pattern : patterns) {
      const std::vector<fs::path> files = filesOf(entry.folderOf("scenario"), pattern);
      if (files.empty()) entry.fault("scenario", fmt::format("no such file {}", base::inQuotes(pattern)));
      for (const fs::path& file : files)
        addScenario(entry, file, name, patterns.size() + files.size() > 2, run, choices.seeds);
    }
  }

  void addScenario(YamlReader& entry, const fs::path& file, const std::string& name, bool several,
                   PlannedRun run, const std::vector<std::uint64_t>& seeds) {
    run.scenario = file;
    run.scenario_as_written = file.lexically_relative(plan_.path.parent_path()).generic_string();
    const ScenarioAnswer& answer = checks_.check(file, run.image, run.choices.limits);
    if (answer.fault == ScenarioAnswer::Fault::kScenario) return tellOnce(answer.why);
    if (answer.fault == ScenarioAnswer::Fault::kLimits)
      return entry.fault("limits", fmt::format("of {}: {}", run.scenario_as_written, answer.why));
    run.unfit = answer.why;
    run.title = answer.scenario.title;
    run.on_real_pins = answer.scenario.on_real_pins;
    run.files = answer.scenario.files;
    if (!run.choices.limits.empty()) run.limited_scenario = limitedScenario(file, run.choices.limits);
    const std::string stem = name.empty() ? answer.scenario.name
                             : several    ? name + "-" + answer.scenario.name
                                          : name;
    if (seeds.empty()) addRun(entry, run, stem);
    for (const std::uint64_t seed : seeds) {
      run.choices.seed = seed;
      addRun(entry, run, fmt::format("{}-seed-{}", stem, seed));
    }
  }

  /// Several entries may have the same faulty scenario.
  void tellOnce(const std::string& lines) {
    if (std::ranges::find(scenario_faults_, lines) == scenario_faults_.end())
      scenario_faults_.push_back(lines);
  }

  void addRun(YamlReader& entry, PlannedRun run, const std::string& name) {
    run.name = name;
    const auto same = [&](const PlannedRun& other) { return other.folderName() == run.folderName(); };
    if (plan_.runs.size() >= kMostRuns) {
      if (plan_.runs.size() == kMostRuns && !full_)
        entry.fault("scenario", fmt::format("a plan has at most {} runs", kMostRuns));
      full_ = true;
    } else if (!folders_.insert(run.folderName()).second) {
      const auto other = std::ranges::find_if(plan_.runs, same);
      entry.fault("scenario", fmt::format("a run {} is there already, of {}; give one of them another name",
                                          run.name, other->scenario_as_written));
    } else {
      plan_.runs.push_back(std::move(run));
    }
  }

  YamlReader file_;
  const PlanSurroundings& surroundings_;
  ScenarioChecks checks_;
  Plan plan_;
  std::set<std::string> folders_;
  std::vector<std::string> scenario_faults_;
  bool full_{};
};

}  // namespace

std::string nameOfPlan(const fs::path& path) {
  YamlReader file = YamlReader::openFile(path);
  const std::string name = file.text("name", "");
  if (isName(name)) return name;
  throw base::ConfigError(
      fmt::format("{}: name: use letters, digits, '-', '_' and '.'", file.placeOf("name")));
}

Plan readPlan(const fs::path& path, const PlanSurroundings& surroundings) {
  return PlanReader(path, surroundings).read();
}

}  // namespace kerfbench::suite
