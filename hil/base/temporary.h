// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/base/unique_fd.h"

namespace kerfbench::base {

/// A file or folder that must not outlive its owner, nor the process: removed, with all that is in it, by the
/// destructor and by removeTemporaries(). May be used by any thread.
class TemporaryPath {
 public:
  explicit TemporaryPath(std::filesystem::path path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Another path is to be removed in its place; empty: none, since what was there has found its place.
  void becomes(std::filesystem::path path);

 private:
  std::filesystem::path path_;
};

/// Removes what there is of all TemporaryPath of this process, which is to end at once: threads that make or
/// lose one from now on wait for ever.
void removeTemporaries() noexcept;

/// A folder of this process, PARENT/PREFIX.XXXXXX. Those of the same parent and prefix that a process left
/// behind which was killed are removed first; a lock on the folder tells them from those of processes that
/// live.
class TemporaryFolder {
 public:
  /// @throws std::system_error if `parent` cannot be made or written.
  TemporaryFolder(const std::filesystem::path& parent, const std::string& prefix);

  [[nodiscard]] const std::filesystem::path& path() const { return path_.path(); }
  /// As TemporaryPath::becomes().
  void becomes(std::filesystem::path path) { path_.becomes(std::move(path)); }

 private:
  UniqueFd lock_;
  TemporaryPath path_;
};

}  // namespace kerfbench::base
