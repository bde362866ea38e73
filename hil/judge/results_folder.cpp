// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/results_folder.h"

#include <fcntl.h>
#include <stdio.h>  // NOLINT(modernize-deprecated-headers): renameat2 is no part of <cstdio>

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/judge/results_list.h"

namespace kerfbench::judge {
namespace fs = std::filesystem;
namespace {

void refuseForeign(const fs::path& place) {
  const fs::file_status status = fs::symlink_status(place);
  if (!fs::exists(status)) return;
  const std::string why = fs::is_directory(status) ? foreignIn(place) : std::string("is no folder");
  if (why.empty()) return;
  throw base::InputError(
      fmt::format("{} {}; the results would replace it. Move it away, choose another --results-dir, or give "
                  "the scenario another name",
                  place.string(), why));
}

}  // namespace

void refuseForeignResults(const fs::path& parent, const std::string& name) {
  refuseForeign(fs::absolute(parent) / name);
}

ResultsFolder::ResultsFolder(const fs::path& parent, const std::string& name)
    : place_(fs::absolute(parent) / name), staging_(place_.parent_path(), "." + name) {
  fs::permissions(staging(), fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                                 fs::perms::others_read | fs::perms::others_exec);
}

void ResultsFolder::commit() {
  writeResultsList(staging());
  refuseForeign(place_);
  if (renamed(place_, RENAME_NOREPLACE)) {
    staging_.becomes({});
    return;
  }
  // Something is there: exchange the two in one step, then the old one is removed with the temporary name.
  if (errno == EEXIST && renamed(place_, RENAME_EXCHANGE)) return;
  if (errno != EINVAL)
    throw std::system_error(errno, std::generic_category(), "cannot put the results to " + place_.string());
  commitInSteps();
}

void ResultsFolder::commitTo(const fs::path& place) {
  writeResultsList(staging());
  if (!renamed(place, RENAME_NOREPLACE)) {
    if (errno != EINVAL)
      throw std::system_error(errno, std::generic_category(), "cannot put the results to " + place.string());
    // Drives of a network that know no such flag.
    if (fs::exists(fs::symlink_status(place)))
      throw std::system_error(EEXIST, std::generic_category(), "cannot put the results to " + place.string());
    fs::rename(staging(), place);
  }
  place_ = place;
  staging_.becomes({});
}

bool ResultsFolder::renamed(const fs::path& place, unsigned flags) const {
  return ::renameat2(AT_FDCWD, staging().c_str(), AT_FDCWD, place.c_str(), flags) == 0;
}

/// Many drives of a network can neither exchange two names nor leave one that is taken alone. For a moment
/// there is nothing in the place, never a half.
void ResultsFolder::commitInSteps() {
  const fs::path old = staging().string() + ".old";
  std::error_code error;
  fs::rename(place_, old, error);
  const bool there = !error;
  if (error && error != std::errc::no_such_file_or_directory)
    throw std::system_error(error, "cannot put the results to " + place_.string());
  fs::rename(staging(), place_, error);
  if (error) {
    std::error_code ignored;
    if (there) fs::rename(old, place_, ignored);
    throw std::system_error(error, "cannot put the results to " + place_.string());
  }
  staging_.becomes(there ? old : fs::path());
}

}  // namespace kerfbench::judge
