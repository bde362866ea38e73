// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/run_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/base/atomic_file.h"
#include "hil/base/file_content.h"
#include "hil/base/number_from.h"
#include "hil/campaign/key_tree.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;

/// A text of YAML for a file name.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string asSeenFrom(const fs::path& folder, const fs::path& file) {
  return quoted(fs::absolute(file).lexically_normal().lexically_relative(folder).string());
}

std::string withSize(std::string text, std::string_view holder, const std::string& size) {
  for (std::size_t at = 0; (at = text.find(holder, at)) != std::string::npos; at += size.size())
    text.replace(at, holder.size(), size);
  return text;
}

void putDown(const fs::path& file, const std::string& content) {
  if (base::fileContent(file) != content) base::writeFileAtomically(file, content);
}

/// Works out what a run's files say.
class RunKeys {
 public:
  RunKeys(const Campaign& campaign, const RunPlan& plan, fs::path folder)
      : campaign_(campaign), plan_(plan), folder_(std::move(folder)), base_(campaign.bases.at(plan.base)) {}

  RunFiles files() {
    gather(false);
    const bool changes_machine = anyOfMachine();
    if (changes_machine) {
      machine_ = machineFile();
      gather(true);
      scenario_.emplace_back("machine", quoted(machineName()));
    }
    if (plan_.seed) scenario_.emplace_back("seed", fmt::format("{}", *plan_.seed));
    scenario_.emplace_back("name", fmt::format("{}-{}", campaign_.name, runName(plan_.index)));
    RunFiles files{
        fmt::format("# {}\nextends: {}\n{}", headline(), asSeenFrom(folder_, base_), yamlOf(scenario_)),
        std::nullopt};
    if (changes_machine)
      files.machine = fmt::format("# {}\nextends: {}\n{}", headline(), asSeenFrom(folder_, machine_),
                                  yamlOf(machine_keys_));
    return files;
  }

 private:
  [[nodiscard]] std::string headline() const {
    return fmt::format("Run {} of the campaign {}, written by kerfbench campaign.", plan_.index,
                       campaign_.name);
  }
  [[nodiscard]] std::string machineName() const { return runName(plan_.index) + ".machine.yaml"; }

  [[nodiscard]] bool anyOfMachine() const {
    if (std::ranges::any_of(campaign_.fixed, &FixedKey::of_machine)) return true;
    for (std::size_t i = 0; i < plan_.factors.size(); ++i) {
      const Kind& kind = campaign_.factors[i].kinds[plan_.factors[i].kind];
      if (std::ranges::any_of(kind.changes, &Change::of_machine)) return true;
    }
    return false;
  }

  /// The keys of the scenario, or of the machine, that this run changes.
  void gather(bool of_machine) {
    for (const FixedKey& fixed : campaign_.fixed)
      if (fixed.of_machine == of_machine) add(of_machine, fixed.key, fixed.text);
    for (std::size_t i = 0; i < plan_.factors.size(); ++i) {
      const Factor& factor = campaign_.factors[i];
      for (const Change& change : factor.kinds[plan_.factors[i].kind].changes)
        if (change.of_machine == of_machine)
          add(of_machine, change.key, textOf(factor, plan_.factors[i], change));
    }
  }

  void add(bool of_machine, const std::string& key, const std::string& text) {
    // A name that begins with its folder is a file, as seen from the campaign's own.
    const bool is_file = text.starts_with("./") || text.starts_with("../");
    const std::string value = is_file ? asSeenFrom(folder_, campaign_.path.parent_path() / text) : text;
    if (!of_machine && key == "machine" && is_file) machine_ = campaign_.path.parent_path() / text;
    if (!of_machine && key == "machine" && anyOfMachine()) return;  // The run's own machine extends it.
    (of_machine ? machine_keys_ : scenario_).emplace_back(key, value);
  }

  [[nodiscard]] std::string textOf(const Factor& factor, const FactorValue& value,
                                   const Change& change) const {
    const std::string size = !factor.is_fault ? value.value
                             : value.size     ? fmt::format("{}", *value.size)
                                              : "";
    if (change.how == Change::How::kSet)
      return withSize(change.text, factor.is_fault ? kSizeHolder : kValueHolder, size);
    const fs::path& file = change.of_machine ? machine_ : base_;
    const std::optional<std::string> given = textAt(file, change.key);
    const std::optional<double> number = given ? base::numberFrom<double>(*given) : std::nullopt;
    const std::optional<double> by = base::numberFrom<double>(size);
    if (!number || !by) {
      throw base::ConfigError(fmt::format(
          "{}: factor '{}' changes {} by what {} gives, and there {}", campaign_.path.string(), factor.name,
          change.key, file.string(), given ? fmt::format("it is '{}'", *given) : std::string("is none")));
    }
    return fmt::format("{:.12g}", change.how == Change::How::kScale ? *number * (1.0 + change.by * *by)
                                                                    : *number + change.by * *by);
  }

  /// The machine that the run's own extends. Its camera calibrations that lie beside it unnamed are named.
  fs::path machineFile() {
    fs::path file = machine_;
    if (file.empty()) {
      const std::optional<fs::path> named = fileAt(base_, "machine");
      if (!named) throw base::ConfigError(fmt::format("{}: machine: missing", base_.string()));
      file = *named;
    }
    for (const char* camera : {"spot", "kerf"}) {
      const std::string key = fmt::format("cameras.{}.calibration", camera);
      const fs::path beside =
          file.parent_path() / fmt::format("{}.{}.camera.yaml", file.stem().string(), camera);
      if (!fileAt(file, key) && fs::is_regular_file(beside))
        machine_keys_.emplace_back(key, asSeenFrom(folder_, beside));
    }
    return file;
  }

  const Campaign& campaign_;
  const RunPlan& plan_;
  fs::path folder_;
  const fs::path& base_;
  fs::path machine_;
  std::vector<KeyValue> scenario_, machine_keys_;
};

}  // namespace

std::string runName(std::size_t index) { return fmt::format("{:06}", index); }

RunFiles runFilesOf(const Campaign& campaign, const RunPlan& plan, const fs::path& folder) {
  return RunKeys(campaign, plan, folder).files();
}

fs::path writeRunFiles(const Campaign& campaign, const RunPlan& plan, const fs::path& folder) {
  const RunFiles files = runFilesOf(campaign, plan, folder);
  if (files.machine) putDown(folder / (runName(plan.index) + ".machine.yaml"), *files.machine);
  const fs::path scenario = folder / (runName(plan.index) + ".yaml");
  putDown(scenario, files.scenario);
  return scenario;
}

}  // namespace kerfbench::campaign
