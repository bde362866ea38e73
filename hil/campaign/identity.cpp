// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/identity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/version.h"
#include "hil/campaign/run_files.h"
#include "hil/machine_file/machine_file.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kListVersion = 1;
constexpr const char* kList = "campaign.json";
constexpr std::size_t kMostFaults = 20;
constexpr std::array<std::string_view, 5> kOwnFolders{"scenarios", "records", "runs", "slurm", "kept"};

/// Files with their sums, in the order in which they were first named.
class FileSums {
 public:
  void add(const fs::path& file) {
    const fs::path whole = fs::absolute(file).lexically_normal();
    if (!seen_.insert(whole.string()).second || !fs::is_regular_file(whole)) return;
    sums_.emplace_back(whole, base::sha256File(whole));
  }
  [[nodiscard]] const std::vector<std::pair<fs::path, std::string>>& all() const { return sums_; }

 private:
  std::set<std::string> seen_;
  std::vector<std::pair<fs::path, std::string>> sums_;
};

/// Faults of the runs' files; a fault that many runs share is told of the first.
class RunFaults {
 public:
  void add(const std::string& message) {
    for (std::size_t at = 0; at < message.size();) {
      const std::size_t end = std::min(message.find('\n', at), message.size());
      const std::string line = message.substr(at, end - at);
      // "FILE:LINE: what", of which the file is the run's.
      const std::size_t what = line.find(": ");
      if (seen_.insert(what == std::string::npos ? line : line.substr(what)).second &&
          ++count_ <= kMostFaults)
        told_ += (told_.empty() ? "" : "\n") + line;
      at = end + 1;
    }
  }
  void throwIfAny() const {
    if (count_ == 0) return;
    throw base::ConfigError(
        count_ <= kMostFaults ? told_ : fmt::format("{}\nand {} more", told_, count_ - kMostFaults));
  }

 private:
  std::set<std::string> seen_;
  std::size_t count_{};
  std::string told_;
};

bool isUnder(const fs::path& file, const fs::path& folder) {
  const fs::path from = file.lexically_relative(folder);
  return !from.empty() && *from.begin() != "..";
}

/// All files on which the runs depend but the ones that were written for them.
FileSums readAllRuns(const Campaign& campaign, const fs::path& scenarios, const BenchFiles& bench,
                     const base::ProgressFn& progress) {
  FileSums sums;
  for (const fs::path& program : bench.programs) sums.add(program);
  RunFaults faults;
  std::map<fs::path, std::vector<fs::path>> machines;
  base::ShareProgress told(progress, "checking the scenarios of all runs", campaign.runs(), 1);
  for (std::size_t i = 0; i < campaign.runs(); ++i) {
    try {
      const fs::path file = writeRunFiles(campaign, planOf(campaign, i), scenarios);
      const scenario::Scenario scenario = scenario::readScenario(file, bench.images);
      std::vector<fs::path>& inputs = machines[scenario.machine];
      if (inputs.empty()) inputs = machine_file::readMachineFile(scenario.machine).inputs;
      for (const auto& list : {scenario.inputs, inputs})
        for (const fs::path& input : list)
          if (!isUnder(input, scenarios)) sums.add(input);
      if (isUnder(scenario.machine, scenarios)) machines.erase(scenario.machine);
    } catch (const base::ConfigError& e) {
      faults.add(e.what());
    }
    told.done(i + 1);
  }
  faults.throwIfAny();
  return sums;
}

std::string sumOfCampaignFiles(const Campaign& campaign) {
  base::Sha256 sum;
  for (const fs::path& file : campaign.inputs) sum.add(base::sha256File(file));
  return sum.digest();
}

std::string identityFrom(const std::string& campaign_sum, const std::vector<std::string>& sums) {
  base::Sha256 sum;
  sum.add(fmt::format("kerfbench {}\n{}\n", base::version(), campaign_sum));
  for (const std::string& each : sums) sum.add(each + "\n");
  return sum.digest();
}

void refuseForeign(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (std::ranges::find(kOwnFolders, name) == kOwnFolders.end() && !name.starts_with("."))
      throw base::InputError(
          fmt::format("{}: holds '{}', which is no campaign's: name another folder", folder.string(), name));
  }
}

ordered_json listIn(const fs::path& folder) {
  const fs::path file = folder / kList;
  const std::optional<std::string> content = base::fileContent(file);
  if (!content)
    throw base::InputError(fmt::format("{}: has no {}: no campaign was run into it", folder.string(), kList));
  const ordered_json json = ordered_json::parse(*content, nullptr, false);
  if (!json.is_object() || json.value("schema_version", 0) != kListVersion)
    throw base::InputError(fmt::format("{}: is no list of a campaign that this bench reads", file.string()));
  return json;
}

Prepared known(const Campaign& campaign, const fs::path& folder, const ordered_json& list) {
  if (list.at("campaign_sha256") != sumOfCampaignFiles(campaign))
    throw base::InputError(
        fmt::format("{}: was made for the campaign '{}' as its file was: name another folder for {}",
                    folder.string(), list.at("name").get<std::string>(), campaign.path.string()));
  if (list.at("bench") != base::version())
    throw base::InputError(fmt::format("{}: was made by kerfbench {}, and this is {}", folder.string(),
                                       list.at("bench").get<std::string>(), base::version()));
  for (const ordered_json& file : list.at("files")) {
    const fs::path path = (folder / file.at("file").get<std::string>()).lexically_normal();
    if (!fs::is_regular_file(path) || base::sha256File(path) != file.at("sha256"))
      throw base::InputError(
          fmt::format("{}: {} has changed since this campaign was begun: its runs would not "
                      "belong together",
                      folder.string(), path.string()));
  }
  return {folder, list.at("identity").get<std::string>()};
}

}  // namespace

fs::path Prepared::scenarioOf(std::size_t run) const { return scenarios() / (runName(run) + ".yaml"); }

Prepared prepare(const Campaign& campaign, const fs::path& asked, const BenchFiles& bench,
                 const base::ProgressFn& progress) {
  const fs::path folder = fs::absolute(asked).lexically_normal();
  if (fs::exists(folder / kList)) {
    try {
      return known(campaign, folder, listIn(folder));
    } catch (const ordered_json::exception& e) {
      throw base::InputError(fmt::format("{}: {}", (folder / kList).string(), e.what()));
    }
  }
  refuseForeign(folder);
  fs::create_directories(folder / "scenarios");
  const FileSums files = readAllRuns(campaign, folder / "scenarios", bench, progress);
  std::vector<std::string> sums;
  ordered_json list{{"schema_version", kListVersion}, {"name", campaign.name},
                    {"title", campaign.title},        {"bench", base::version()},
                    {"runs", campaign.runs()},        {"campaign_sha256", sumOfCampaignFiles(campaign)},
                    {"files", ordered_json::array()}};
  for (const auto& [file, sum] : files.all()) {
    list["files"].push_back({{"file", file.lexically_relative(folder).string()}, {"sha256", sum}});
    sums.push_back(sum);
  }
  list["identity"] = identityFrom(list["campaign_sha256"], sums);
  base::writeFileAtomically(folder / kList,
                            list.dump(2, ' ', false, decltype(list)::error_handler_t::replace) + "\n");
  return {folder, list["identity"].get<std::string>()};
}

KnownCampaign knownCampaign(const fs::path& asked) {
  const fs::path folder = fs::absolute(asked).lexically_normal();
  const ordered_json list = listIn(folder);
  try {
    return {{folder, list.at("identity").get<std::string>()},
            list.at("name").get<std::string>(),
            list.at("title").get<std::string>(),
            list.at("runs").get<std::size_t>()};
  } catch (const ordered_json::exception& e) {
    throw base::InputError(fmt::format("{}: {}", (folder / kList).string(), e.what()));
  }
}

}  // namespace kerfbench::campaign
