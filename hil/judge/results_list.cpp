// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/results_list.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"

namespace kerfbench::judge {
namespace fs = std::filesystem;
namespace {

constexpr const char* kListHead =
    "Results of kerfbench. The bench removes or replaces the folder only as long as it holds these files "
    "alone:";
/// Head of the lists of earlier benches.
constexpr const char* kEarlierListHead =
    "Results of kerfbench. The next run of this name replaces the folder as long as it holds these files "
    "alone:";
constexpr std::size_t kSumDigits = 64;
constexpr const char* kBehindSum = "  ";

/// Sums of a list by path; empty: none is known, as of a link or of a list from before there were sums.
using Sums = std::map<std::string, std::string>;

/// Everything below a folder but its own list, as paths from there: files, links and empty folders.
std::set<std::string> contentOf(const fs::path& folder) {
  std::set<std::string> content;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const bool filled = entry.is_directory() && !entry.is_symlink() && !fs::is_empty(entry.path());
    if (!filled) content.insert(entry.path().lexically_relative(folder).generic_string());
  }
  content.erase(kResultsList);
  return content;
}

std::string sumOf(const fs::path& file) {
  return fs::is_regular_file(fs::symlink_status(file)) ? base::sha256File(file) : std::string();
}

/// The list of a folder; nullopt: it has none.
std::optional<Sums> readList(const fs::path& folder) {
  std::istringstream file(base::fileContent(folder / kResultsList).value_or(""));
  std::string line;
  if (!std::getline(file, line) || (line != kListHead && line != kEarlierListHead)) return std::nullopt;
  Sums sums;
  while (std::getline(file, line)) {
    const bool has_sum = line.find_first_not_of("0123456789abcdef") == kSumDigits &&
                         line.compare(kSumDigits, 2, kBehindSum) == 0;
    if (has_sum) {
      sums[line.substr(kSumDigits + 2)] = line.substr(0, kSumDigits);
    } else {
      sums[line] = "";
    }
  }
  return sums;
}

}  // namespace

void writeResultsList(const fs::path& folder) {
  std::string text = std::string(kListHead) + "\n";
  for (const std::string& path : contentOf(folder)) {
    const std::string sum = sumOf(folder / path);
    if (!sum.empty()) text.append(sum).append(kBehindSum);
    text.append(path).append("\n");
  }
  base::writeFileAtomically(folder / kResultsList, text);
}

std::string foreignIn(const fs::path& folder) {
  const std::set<std::string> content = contentOf(folder);
  if (content.empty()) return {};
  const std::optional<Sums> listed = readList(folder);
  if (!listed) return fmt::format("has no {}, so it is no results folder", kResultsList);
  for (const std::string& path : content) {
    if (!listed->contains(path)) return fmt::format("holds '{}', which no run wrote", path);
  }
  return {};
}

std::vector<std::string> changedSinceListed(const fs::path& folder) {
  const std::optional<Sums> listed = fs::is_directory(folder) ? readList(folder) : std::nullopt;
  if (!listed)
    throw base::InputError(
        fmt::format("{}: has no {}, so it is no results folder", folder.string(), kResultsList));
  const std::set<std::string> content = contentOf(folder);
  std::vector<std::string> changes;
  for (const auto& [path, sum] : *listed) {
    if (!content.contains(path)) {
      changes.push_back(path + " is missing");
    } else if (sum.empty()) {
      changes.push_back(path + " has no sum in the list");
    } else if (sum != sumOf(folder / path)) {
      changes.push_back(path + " is not what the run wrote");
    }
  }
  for (const std::string& path : content) {
    if (!listed->contains(path)) changes.push_back(path + " was added");
  }
  return changes;
}

}  // namespace kerfbench::judge
