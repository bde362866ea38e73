// SPDX-License-Identifier: Apache-2.0
#include "hil/app/results_folder.h"

#include <fcntl.h>
#include <stdio.h>   // NOLINT(modernize-deprecated-headers): renameat2 is no part of <cstdio>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is no part of <cstdlib>

#include <cerrno>
#include <system_error>

namespace kerfbench::hil {
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
  if (::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, place_.c_str(), RENAME_NOREPLACE) == 0) {
    staging_.clear();
    return;
  }
  // Something is there: exchange the two in one step, then the destructor removes the old one.
  if (errno != EEXIST ||
      ::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, place_.c_str(), RENAME_EXCHANGE) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot put the results to " + place_.string());
  }
}

}  // namespace kerfbench::hil
