// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/base/unique_fd.h"

namespace kerfbench::batch {

/// Keeps a folder for this process: a second one that wants it is refused. The kernel holds the lock and
/// gives it back with the process, however that ends. A hidden file in the folder says who has it.
class FolderLock {
 public:
  /// The folder must be there.
  /// @throws base::InputError that names folder and process, if another one has it; std::system_error.
  explicit FolderLock(const std::filesystem::path& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  base::UniqueFd fd_;
};

}  // namespace kerfbench::batch
