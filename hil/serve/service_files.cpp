// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/service_files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "hil/base/yaml_reader.h"
#include "hil/judge/run_folder.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::array<std::string_view, 3> kPictures{".png", ".jpg", ".jpeg"};

/// Files with names of their own, as `calibrate head --by-hand` has them.
struct KnownName {
  std::string_view name, kind;
};
constexpr std::array<KnownName, 4> kKnownNames{{{"tiles.yaml", "tiles"},
                                                {"scan.yaml", "scan-list"},
                                                {"correction.csv", "table"},
                                                {"table.csv", "table"}}};

/// Keys by which a calibration tells what it is of.
constexpr std::array<KnownName, 3> kKnownKeys{
    {{"camera_id", "camera"}, {"scanner_id", "scanner"}, {"square_mm", "target"}}};

/// Whether a run has written it: below results/NAME/DATE-DIGEST.
bool isOfARun(const fs::path& name) {
  auto part = name.begin();
  for (int i = 0; i < 2 && part != name.end(); ++i) ++part;
  return name.begin()->string() == "results" && part != name.end() && judge::isRunFolderName(part->string());
}

std::optional<Json> calibrationIn(const fs::path& path, const std::string& name) {
  try {
    base::YamlReader file = base::YamlReader::openFile(path);
    for (const auto& [key, kind] : kKnownKeys) {
      if (!file.has(std::string(key))) continue;
      Json row{{"path", name}, {"kind", kind}};
      if (kind != "target") row["id"] = file.text(std::string(key), "");
      if (file.has("date")) row["date"] = file.text("date", "");
      return row;
    }
  } catch (const std::exception&) {
    // A text that cannot be read is no calibration; what it is meant to be stands among the scenarios.
  }
  return std::nullopt;
}

std::optional<Json> rowOf(const WorkFolder& files, const std::string& name) {
  const fs::path path(name);
  const std::string file = path.filename().string(), ending = path.extension().string();
  for (const auto& [known, kind] : kKnownNames)
    if (file == known) return Json{{"path", name}, {"kind", kind}};
  if (std::ranges::find(kPictures, ending) != kPictures.end())
    return Json{{"path", name}, {"kind", path.stem() == "scan" ? "scan" : "photograph"}};
  if (ending != ".yaml") return std::nullopt;
  if (!name.starts_with(kShipped)) return calibrationIn(files.folder() / name, name);
  return calibrationIn(files.shipped().fixtures / name.substr(kShipped.size()), name);
}

}  // namespace

ServiceLists serviceLists(const WorkFolder& files, const std::vector<std::string>& names) {
  ServiceLists lists;
  std::vector<std::pair<fs::file_time_type, std::string>> folders;
  for (const std::string& name : names) {
    const fs::path path(name);
    if (isOfARun(path) || name.starts_with("shipped/firmware/")) continue;
    if (path.filename() == "steps.json" && !name.starts_with(kShipped)) {
      std::error_code error;
      const fs::file_time_type written = fs::last_write_time(files.folder() / name, error);
      if (!error) folders.emplace_back(written, path.parent_path().generic_string());
    }
    if (auto row = rowOf(files, name)) lists.files.push_back(*std::move(row));
  }
  std::ranges::sort(folders, std::greater{});
  for (const auto& [written, folder] : folders) lists.folders.push_back({{"path", folder}});
  return lists;
}

}  // namespace kerfbench::serve
