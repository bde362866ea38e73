// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/file_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "hil/base/file_content.h"
#include "hil/base/yaml_reader.h"
#include "hil/judge/run_folder.h"
#include "hil/serve/service_files.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::array kDrawings{".dxf", ".svg", ".pdf", ".cf2"};
constexpr std::array kImages{".hex", ".elf", ".bin"};
/// Folders of a repository in which nobody keeps jobs.
constexpr std::array kPassedBy{"build", "node_modules", "results"};

template <std::size_t N>
bool isOneOf(const std::array<const char*, N>& all, const std::string& word) {
  return std::ranges::find(all, word) != all.end();
}

/// Files below a folder by name, sorted; hidden ones and those of other people's packages are passed by.
struct Walk {
  std::vector<std::string> names;
  std::size_t left_out{};

  void add(const fs::path& root, const std::string& before, bool with_results) {
    std::error_code ignored;
    auto entry =
        fs::recursive_directory_iterator(root, fs::directory_options::skip_permission_denied, ignored);
    for (; entry != fs::recursive_directory_iterator(); entry.increment(ignored)) {
      const std::string own = entry->path().filename().string();
      const bool is_folder = entry->is_directory(ignored);
      const bool passed_by =
          is_folder && entry.depth() == 0 && isOneOf(kPassedBy, own) && !(with_results && own == "results");
      if (is_folder && (own.starts_with('.') || passed_by || entry.depth() >= kDeepestFolder))
        entry.disable_recursion_pending();
      if (is_folder || own.starts_with('.') || !entry->is_regular_file(ignored)) continue;
      const std::string name = before + entry->path().lexically_relative(root).generic_string();
      if (names.size() >= kMostFilesSeen || !isReadableName(name))
        ++left_out;
      else
        names.push_back(name);
    }
  }
};

enum class YamlKind { kScenario, kMachine, kOther };

struct YamlFile {
  YamlKind kind{YamlKind::kOther};
  std::string name, title, problem;
  Json firmware;  ///< Section of a scenario.
};

/// Keys that only machine files and only scenarios have.
YamlKind kindOf(const base::YamlReader& file) {
  if (file.has("machine") && (file.has("dieline") || file.has("firmware"))) return YamlKind::kScenario;
  if (file.has("kind") && file.has("pins")) return YamlKind::kMachine;
  return YamlKind::kOther;
}

Json firmwareOf(base::YamlReader& file) {
  Json firmware = Json::object();
  for (const auto& [keys, text] : file.leaves("firmware")) {
    // Numbers are numbers in YAML, too, but not in the reader's texts.
    const bool is_number =
        !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    if (keys.size() == 1) firmware[keys.front()] = is_number ? Json(std::stoll(text)) : Json(text);
  }
  return firmware;
}

YamlFile readYaml(const fs::path& path) {
  YamlFile read;
  try {
    base::YamlReader file = base::YamlReader::openFile(path);
    read.kind = kindOf(file);
    if (read.kind == YamlKind::kOther) return read;
    read.name = file.text("name", "");
    if (read.kind == YamlKind::kScenario) {
      read.title = file.text("title", "");
      read.firmware = firmwareOf(file);
    }
  } catch (const std::exception& fault) {
    // Whatever it was meant to be, its author looks for it among the scenarios.
    read.kind = YamlKind::kScenario;
    read.problem = fault.what();
  }
  if (read.name.empty()) read.name = path.stem().string();
  return read;
}

/// What is to be set in a scenario to run a release: as the scenarios that come with the bench have it for a
/// release of the same controller.
class Releases {
 public:
  void learn(const Json& firmware) {
    if (firmware.contains("image") && firmware.contains("mcu"))
      known_.emplace(familyOf(firmware["image"].get<std::string>()), firmware);
  }
  [[nodiscard]] Json row(const std::string& name, const std::string& image) const {
    Json row{{"path", name}, {"title", fs::path(name).filename().string()}};
    const auto found = known_.find(familyOf(image));
    if (found != known_.end()) {
      row["firmware"] = found->second;
      row["firmware"]["image"] = image;
    }
    return row;
  }

 private:
  /// "avr.hex" of "controller-avr.hex" and "fault-dir-late-avr.hex".
  static std::string familyOf(const std::string& image) {
    const std::string file = fs::path(image).filename().string();
    return file.substr(std::min(file.rfind('-') + 1, file.size()));
  }
  std::map<std::string, Json> known_;
};

std::vector<std::string> runFolders(const fs::path& results) {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const auto& scenario : fs::directory_iterator(results, ignored)) {
    const std::string name = scenario.path().filename().string();
    if (name.starts_with('.') || !scenario.is_directory(ignored)) continue;
    for (const auto& run : fs::directory_iterator(scenario.path(), ignored)) {
      const std::string date = run.path().filename().string();
      if (judge::isRunFolderName(date) && !run.is_symlink(ignored)) found.push_back(name + "/" + date);
    }
  }
  // Dates, the newest first; then the alphabet.
  std::ranges::sort(found, [](const std::string& a, const std::string& b) {
    const auto date = [](const std::string& path) { return path.substr(path.rfind('/') + 1); };
    return std::pair(date(b), a) < std::pair(date(a), b);
  });
  return found;
}

/// "2026-11-28T16:05:12Z" of "20261128T160512Z-1a2b3c4d".
std::string dateOf(const std::string& run) {
  const std::string name = run.substr(run.rfind('/') + 1);
  return fmt::format("{}-{}-{}T{}:{}:{}Z", name.substr(0, 4), name.substr(4, 2), name.substr(6, 2),
                     name.substr(9, 2), name.substr(11, 2), name.substr(13, 2));
}

}  // namespace

Json FileList::verdictOf(const std::string& run_folder) const {
  {
    const std::lock_guard lock(mutex_);
    const auto known = verdicts_.find(run_folder);
    if (known != verdicts_.end()) return Json::parse(known->second);
  }
  const fs::path folder = files_.folder() / "results" / run_folder;
  const std::optional<std::string> text = base::fileContent(folder / "verdict.json");
  const Json verdict = text ? Json::parse(*text, nullptr, false) : Json();
  Json row{{"path", "results/" + run_folder}, {"when", dateOf(run_folder)}};
  if (!verdict.is_object()) {
    row["scenario"] = run_folder.substr(0, run_folder.find('/'));
    row["verdict"] = nullptr;
    return row;
  }
  for (const char* key : {"scenario", "verdict", "serial_number"})
    if (verdict.contains(key)) row[key] = verdict[key];
  const std::lock_guard lock(mutex_);
  verdicts_[run_folder] = row.dump();
  return row;
}

Json FileList::json() const {
  Walk walk;
  walk.add(files_.folder(), "", true);
  walk.add(files_.shipped().fixtures, std::string(kShipped), false);
  walk.add(files_.shipped().firmware, std::string(kShipped) + "firmware/", false);
  std::ranges::sort(walk.names);
  Json list{{"scenarios", Json::array()}, {"machines", Json::array()}, {"drawings", Json::array()},
            {"images", Json::array()},    {"runs", Json::array()},     {"traces", Json::array()}};
  Releases releases;
  std::vector<std::string> images;
  for (const std::string& name : walk.names) {
    const std::string ending = fs::path(name).extension().string();
    const bool is_result = name.starts_with("results/");
    const bool is_firmware = name.starts_with("shipped/firmware/");
    if (ending == ".mcap") {
      std::error_code ignored;
      list["traces"].push_back({{"path", name}, {"bytes", fs::file_size(files_.folder() / name, ignored)}});
    }
    if (is_result) continue;
    const bool is_native = is_firmware && ending.empty();
    if (isOneOf(kImages, ending) || is_native) images.push_back(name);
    if (isOneOf(kDrawings, ending)) list["drawings"].push_back({{"path", name}});
    if (ending != ".yaml" || is_firmware) continue;
    const YamlFile file =
        readYaml(name.starts_with(kShipped) ? files_.shipped().fixtures / name.substr(kShipped.size())
                                            : files_.folder() / name);
    if (file.kind == YamlKind::kMachine) list["machines"].push_back({{"path", name}, {"name", file.name}});
    if (file.kind != YamlKind::kScenario) continue;
    Json row{{"path", name}, {"name", file.name}, {"title", file.title}};
    if (!file.problem.empty()) row["problem"] = file.problem;
    list["scenarios"].push_back(std::move(row));
    releases.learn(file.firmware);
  }
  // Shipped ones are named without their folder, as scenarios name them.
  for (const std::string& name : images)
    list["images"].push_back(
        releases.row(name, name.starts_with(kShipped) ? fs::path(name).filename().string() : name));
  ServiceLists service = serviceLists(files_, walk.names);
  list["service"] = std::move(service.folders);
  list["service_files"] = std::move(service.files);
  const std::vector<std::string> runs = runFolders(files_.folder() / "results");
  for (std::size_t i = 0; i < std::min(runs.size(), kMostRunsListed); ++i)
    list["runs"].push_back(verdictOf(runs[i]));
  list["left_out"] = walk.left_out + (runs.size() - std::min(runs.size(), kMostRunsListed));
  return list;
}

}  // namespace kerfbench::serve
