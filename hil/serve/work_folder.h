// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "hil/base/unique_fd.h"

namespace kerfbench::serve {

/// Names of files below this are those that come with the bench, to be read and never written.
inline constexpr std::string_view kShipped{"shipped/"};

/// Folders of what comes with the bench.
struct ShippedFolders {
  std::filesystem::path fixtures;  ///< Scenarios, machines, drawings: "shipped/scenarios/…".
  std::filesystem::path firmware;  ///< Releases: "shipped/firmware/…".
};
/// Where they are, seen from the programs: beside them as installed, or in the repository.
/// @throws base::InputError where there are none.
ShippedFolders shippedFolders(const std::filesystem::path& bin_dir);

/// The folder in which the user works, and what comes with the bench: the only files that a client can name.
/// A name is relative, with '/', and the kernel itself looks that it leads nowhere else, by no symbolic link
/// either (openat2, RESOLVE_BENEATH).
class WorkFolder {
 public:
  /// Absolute paths. @throws base::InputError if the folder cannot be read.
  WorkFolder(std::filesystem::path folder, ShippedFolders shipped);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const ShippedFolders& shipped() const { return shipped_; }

  /// Opens a file for reading. @throws Refusal 400 for what is no name, 403 for a name that leads out of the
  /// folder, 404.
  [[nodiscard]] base::UniqueFd open(const std::string& name) const;
  /// Absolute path of a file that is there. @throws Refusal as open().
  [[nodiscard]] std::filesystem::path pathOf(const std::string& name) const;
  /// Absolute path of a file that is there or may be written. @throws Refusal as write().
  [[nodiscard]] std::filesystem::path placeOf(const std::string& name) const;
  /// Name of a file by its path; empty: it is not one of these.
  [[nodiscard]] std::string nameOf(const std::filesystem::path& path) const;

  /// @throws Refusal 400, 403, 415 for a name that write() does not take.
  static void refuseUnwritable(const std::string& name);
  /// Writes a file whole or not at all, and the folders that it is in; `content` hands on the bytes piece by
  /// piece and throws where they do not come as a whole. @throws Refusal 400, 403, 415; std::system_error.
  void write(const std::string& name,
             const std::function<void(const std::function<void(std::string_view)>& take)>& content) const;

 private:
  /// A folder, and the path of a file from there.
  struct Place {
    int root{};
    std::filesystem::path root_path;
    std::string rest;
  };
  [[nodiscard]] Place placeIn(const std::string& name) const;

  std::filesystem::path folder_;
  ShippedFolders shipped_;
  base::UniqueFd folder_fd_, fixtures_fd_, firmware_fd_;
};

/// Whether a file of this name may be read: relative, no part hidden, no control character, UTF-8.
bool isReadableName(std::string_view name);
/// Whether a file of this name may be written: besides that only A-Z a-z 0-9 blank . _ - in each part, none
/// that begins with '-', and not among the results, which runs alone write.
bool isWritableName(std::string_view name);

}  // namespace kerfbench::serve
