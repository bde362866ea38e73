// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/plan.h"

#include <fnmatch.h>

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/base/yaml_reader.h"

namespace kerfbench::suite {
namespace {

bool matches(const std::string& pattern, const PlannedRun& run) {
  return ::fnmatch(pattern.c_str(), run.name.c_str(), 0) == 0;
}

bool hasTag(const PlannedRun& run, const std::string& tag) {
  return std::ranges::find(run.tags, tag) != run.tags.end();
}

/// True if `is_of` holds for one of the words, or there are none.
template <typename IsOf>
bool anyOf(const std::vector<std::string>& words, const IsOf& is_of) {
  return words.empty() || std::ranges::any_of(words, is_of);
}

/// Words that are those of no run, a line each.
template <typename IsOf>
std::string strangers(const Plan& plan, const std::vector<std::string>& words, const char* sentence,
                      const IsOf& is_of) {
  std::string lines;
  for (const std::string& word : words) {
    const bool known =
        std::ranges::any_of(plan.runs, [&](const PlannedRun& run) { return is_of(run, word); });
    if (!known) lines += fmt::format(fmt::runtime(sentence), plan.path.string(), base::inQuotes(word));
  }
  return lines;
}

}  // namespace

std::string describe(const Expectation& expectation) {
  return expectation.by.empty()
             ? expectation.verdict
             : fmt::format("{} by {}", expectation.verdict, fmt::join(expectation.by, ", "));
}

std::string PlannedRun::folderName() const {
  std::string folder = name;
  std::ranges::replace(folder, '.', '_');
  return folder;
}

std::size_t select(Plan& plan, const Selection& selection) {
  const auto pattern_of = [](const PlannedRun& run, const std::string& word) { return matches(word, run); };
  const auto name_of = [](const PlannedRun& run, const std::string& word) { return run.name == word; };
  const std::vector<std::string> names = selection.names.value_or(std::vector<std::string>());
  std::string faults = strangers(plan, selection.tags, "{}: no run has the tag {}\n", hasTag) +
                       strangers(plan, selection.patterns, "{}: no run has a name like {}\n", pattern_of) +
                       strangers(plan, names, "{}: no run is called {} any more\n", name_of);
  if (!faults.empty()) throw base::InputError(faults.substr(0, faults.size() - 1));
  const std::size_t before = plan.runs.size();
  std::erase_if(plan.runs, [&](const PlannedRun& run) {
    const bool is_named = !selection.names || std::ranges::find(names, run.name) != names.end();
    return !is_named || !anyOf(selection.tags, [&](const std::string& tag) { return hasTag(run, tag); }) ||
           !anyOf(selection.patterns, [&](const std::string& pattern) { return matches(pattern, run); });
  });
  if (plan.runs.empty()) throw base::InputError(fmt::format("{}: no run is selected", plan.path.string()));
  return before - plan.runs.size();
}

void refuseUnfit(const Plan& plan) {
  std::string faults;
  for (const PlannedRun& run : plan.runs) {
    if (run.unfit.empty()) continue;
    faults += fmt::format("{}: {}: {} does not fit its controller: {}\n", run.place, run.name,
                          run.image.string(), run.unfit);
    if (run.takes_release && faults.find("takes_release") == std::string::npos)
      faults +=
          "(runs are left out by --tag and --only; takes_release: false in the plan lets one keep its "
          "image)\n";
  }
  if (!faults.empty()) throw base::ConfigError(faults.substr(0, faults.size() - 1));
}

}  // namespace kerfbench::suite
