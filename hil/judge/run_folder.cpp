// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/run_folder.h"

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is no part of <cstdlib>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/judge/results_list.h"

namespace kerfbench::judge {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigestDigits = 8;
constexpr std::size_t kDateDigits = 16;  // 20261128T160512Z
constexpr const char* kVerdict = "verdict.json";

bool areDigits(std::string_view text, std::string_view digits) {
  return !text.empty() && text.find_first_not_of(digits) == std::string_view::npos;
}

/// First free name: NAME, NAME-2, NAME-3 …
fs::path freePlace(const fs::path& parent, const std::string& name) {
  fs::path place = parent / name;
  for (int number = 2; fs::exists(fs::symlink_status(place)); ++number)
    place = parent / fmt::format("{}-{}", name, number);
  return place;
}

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::system_error(error, std::generic_category(), what);
}

std::string digestIn(const fs::path& folder) {
  const auto json = nlohmann::json::parse(base::fileContent(folder / kVerdict).value_or(""), nullptr, false);
  const auto digest = json.is_object() ? json.find("digest") : json.end();
  return json.is_object() && digest != json.end() && digest->is_string() ? digest->get<std::string>()
                                                                         : std::string();
}

/// When a file was written, on the system's clock.
std::chrono::system_clock::time_point writtenAt(const fs::path& file) {
  return std::chrono::time_point_cast<std::chrono::system_clock::duration>(
      std::chrono::file_clock::to_sys(fs::last_write_time(file)));
}

/// Results that lie in the folder of the scenario itself, as older benches put them there, become one of its
/// runs. Two renames: in between they are in a hidden folder beside it.
void adoptOlderResults(const fs::path& name_folder) {
  if (!fs::exists(name_folder / kResultsList) || !fs::exists(name_folder / kVerdict)) return;
  const std::string name = runFolderName(writtenAt(name_folder / kVerdict), digestIn(name_folder));
  std::string pattern =
      (name_folder.parent_path() / ("." + name_folder.filename().string() + ".XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr)
    fail("cannot make a folder in " + name_folder.parent_path().string(), errno);
  const fs::path parent = pattern;
  fs::permissions(parent, fs::status(name_folder).permissions());
  fs::rename(name_folder, parent / name);
  fs::rename(parent, name_folder);
}

/// Absolute and without a slash at its end; empty for an empty one.
fs::path wholePath(const fs::path& path) {
  if (path.empty()) return {};
  const fs::path whole = fs::absolute(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

std::string runFolderName(std::chrono::system_clock::time_point ended, const std::string& digest) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(ended);
  const std::string digits = areDigits(digest.substr(0, kDigestDigits), "0123456789abcdef")
                                 ? digest.substr(0, kDigestDigits)
                                 : std::string(kDigestDigits, '0');
  return fmt::format("{:%Y%m%dT%H%M%SZ}-{}", fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)),
                     digits);
}

bool isRunFolderName(const std::string& name) {
  if (name.size() < kDateDigits + 1 + kDigestDigits) return false;
  const std::string_view text = name;
  if (!areDigits(text.substr(0, 8), "0123456789") || text[8] != 'T' ||
      !areDigits(text.substr(9, 6), "0123456789") || text.substr(15, 2) != "Z-" ||
      !areDigits(text.substr(kDateDigits + 1, kDigestDigits), "0123456789abcdef"))
    return false;
  const std::string_view rest = text.substr(kDateDigits + 1 + kDigestDigits);
  return rest.empty() || (rest.front() == '-' && areDigits(rest.substr(1), "0123456789"));
}

void linkLatest(const fs::path& folder) {
  const fs::path link = folder.parent_path() / kLatestRun;
  const fs::path fresh = folder.parent_path() / fmt::format(".{}.{}", kLatestRun, folder.filename().string());
  std::error_code ignored;
  fs::remove(fresh, ignored);
  fs::create_directory_symlink(folder.filename(), fresh);
  fs::rename(fresh, link);
}

void refuseBlockedRuns(const fs::path& results_dir, const std::string& name, const fs::path& output) {
  if (!output.empty()) {
    if (!fs::exists(fs::symlink_status(output))) return;
    throw base::InputError(fmt::format(
        "{} is there already; --output makes a folder of its own for the results", output.string()));
  }
  const fs::path folder = fs::absolute(results_dir) / name;
  const auto refuse = [](const fs::path& place, const char* what) {
    throw base::InputError(
        fmt::format("{} is no {}; the results cannot be put there. Move it away, choose another "
                    "--results-dir, or give the scenario another name",
                    place.string(), what));
  };
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (!fs::is_directory(folder)) refuse(folder, "folder");
  const fs::file_status latest = fs::symlink_status(folder / kLatestRun);
  if (fs::exists(latest) && !fs::is_symlink(latest)) refuse(folder / kLatestRun, "link");
}

RunFolder::RunFolder(const fs::path& results_dir, const std::string& name, const fs::path& output)
    : name_folder_(fs::absolute(results_dir) / name), output_(wholePath(output)) {
  if (output_.empty())
    folder_.emplace(results_dir, name);
  else
    folder_.emplace(output_.parent_path(), output_.filename().string());
}

void RunFolder::commit(std::chrono::system_clock::time_point ended, const std::string& digest) {
  if (!output_.empty()) {
    place_ = output_;
    folder_->commitTo(place_);
    return;
  }
  adoptOlderResults(name_folder_);
  fs::create_directories(name_folder_);
  place_ = freePlace(name_folder_, runFolderName(ended, digest));
  folder_->commitTo(place_);
  linkLatest(place_);
}

}  // namespace kerfbench::judge
