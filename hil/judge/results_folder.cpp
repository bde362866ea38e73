// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/results_folder.h"

#include <fcntl.h>
#include <stdio.h>   // NOLINT(modernize-deprecated-headers): renameat2 is no part of <cstdio>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is no part of <cstdlib>

#include <cerrno>
#include <system_error>

namespace kerfbench::judge {
namespace fs = std::filesystem;

ResultsFolder::ResultsFolder(const fs::path& parent, const std::string& name)
    : place_(fs::absolute(parent) / name) {
  fs::create_directories(place_.parent_path());
  std::string pattern = (place_.parent_path() / ("." + name + ".XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw std::system_error(errno, std::generic_category(),
                            "cannot make a folder in " + place_.parent_path().string());
  }
  staging_ = pattern;
  fs::permissions(staging_, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                                fs::perms::others_read | fs::perms::others_exec);
}

ResultsFolder::~ResultsFolder() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

void ResultsFolder::commit() {
  if (renamed(RENAME_NOREPLACE)) {
    staging_.clear();
    return;
  }
  // Something is there: exchange the two in one step, then the destructor removes the old one.
  if (errno == EEXIST && renamed(RENAME_EXCHANGE)) return;
  if (errno != EINVAL)
    throw std::system_error(errno, std::generic_category(), "cannot put the results to " + place_.string());
  commitInSteps();
}

bool ResultsFolder::renamed(unsigned flags) const {
  return ::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, place_.c_str(), flags) == 0;
}

/// Many drives of a network can neither exchange two names nor leave one that is taken alone. For a moment
/// there is nothing in the place, never a half.
void ResultsFolder::commitInSteps() {
  const fs::path old = staging_.string() + ".old";
  std::error_code error;
  fs::rename(place_, old, error);
  const bool there = !error;
  if (error && error != std::errc::no_such_file_or_directory)
    throw std::system_error(error, "cannot put the results to " + place_.string());
  fs::rename(staging_, place_, error);
  if (error) {
    std::error_code ignored;
    if (there) fs::rename(old, place_, ignored);
    throw std::system_error(error, "cannot put the results to " + place_.string());
  }
  staging_ = there ? old : fs::path();  // The destructor removes it.
}

}  // namespace kerfbench::judge
