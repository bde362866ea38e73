// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "hil/base/temporary.h"
#include "hil/base/unique_fd.h"

namespace kerfbench::base {

/// The folder of a file that shall be written is not there, is no folder, or may not be written in: what()
/// names both and says why.
struct FolderError : std::system_error {
  using std::system_error::system_error;
};

/// A file that is written in pieces, and is there whole or not at all: a nameless one in its folder, or where
/// the drive has no such files a temporary next to it; commit() does fsync, rename, fsync of the folder.
/// Without commit() nothing is left, however the process ends.
class AtomicFile {
 public:
  /// @throws FolderError, or std::system_error with the path, as the others.
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view content);
  void commit();

 private:
  void giveName();

  std::filesystem::path path_;
  std::optional<TemporaryPath> temporary_;  ///< Name of the temporary; empty: it has none yet.
  UniqueFd fd_;
};

/// Writes a file whole or not at all, as an AtomicFile.
/// @throws FolderError, or std::system_error with the path.
void writeFileAtomically(const std::filesystem::path& path, std::string_view content);

}  // namespace kerfbench::base
