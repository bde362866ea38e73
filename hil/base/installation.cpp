// SPDX-License-Identifier: Apache-2.0
#include "hil/base/installation.h"

#include <system_error>

namespace kerfbench::base {

namespace fs = std::filesystem;

namespace {

fs::path above(const fs::path& bin_dir) { return (bin_dir / "../../..").lexically_normal(); }

fs::path installedData(const fs::path& bin_dir) { return above(bin_dir) / "share" / "kerfbench"; }

}  // namespace

bool isInstalled(const fs::path& bin_dir) {
  std::error_code ignored;
  return fs::is_directory(installedData(bin_dir), ignored);
}

fs::path shippedData(const fs::path& bin_dir) {
  return isInstalled(bin_dir) ? installedData(bin_dir) : above(bin_dir) / "fixtures";
}

fs::path referencePages(const fs::path& bin_dir) {
  return isInstalled(bin_dir) ? installedData(bin_dir) / "reference" : above(bin_dir) / "docs" / "reference";
}

fs::path windowPages(const fs::path& bin_dir) { return bin_dir.parent_path() / "window"; }

}  // namespace kerfbench::base
