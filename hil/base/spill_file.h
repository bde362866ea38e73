// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <span>

#include "hil/base/unique_fd.h"

namespace kerfbench::base {

/// Folder for files of many gigabytes that nobody needs afterwards: TMPDIR, or else /var/tmp, since /tmp is
/// in memory on many systems.
std::filesystem::path spillFolder();

/// A temporary file without a name, which is gone with its last owner, however the program ends. It only
/// grows. Several owners may hold it, each a beginning of it; see claim().
class SpillFile {
 public:
  /// @throws std::system_error with the folder.
  explicit SpillFile(std::filesystem::path folder);

  /// Lets one owner go on behind its `size` bytes; false: another has done so, and the caller needs a file of
  /// its own.
  [[nodiscard]] bool claim(std::size_t size, std::size_t more) {
    return claimed_.compare_exchange_strong(size, size + more);
  }
  /// Writes what was claimed there. The space is had from the file system before, because later a full disk
  /// would be the end of the program (SIGBUS) or of the bytes.
  /// @throws std::system_error with the folder and the size that is needed.
  void write(std::size_t at, std::span<const std::byte> bytes);

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  void allocate(std::size_t size);
  [[noreturn]] void fail(int error, std::size_t size) const;

  std::filesystem::path folder_;
  UniqueFd fd_;
  std::atomic<std::size_t> claimed_{};
  std::size_t allocated_{};  ///< Used by the one that has the claim.
};

}  // namespace kerfbench::base
