// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "hil/base/unique_fd.h"

namespace kerfbench::base {

/// Most bytes of a file of settings, in YAML.
inline constexpr std::uint64_t kLargestConfig_bytes = std::uint64_t{1} << 20U;
/// Most bytes of a record that the bench wrote itself: a verdict, a list, a log.
inline constexpr std::uint64_t kLargestRecord_bytes = std::uint64_t{64} << 20U;
/// Most bytes of a picture's file.
inline constexpr std::uint64_t kLargestPicture_bytes = std::uint64_t{256} << 20U;
/// Limit of a reader that goes through a file in pieces, so that its size does not matter.
inline constexpr std::uint64_t kAnySize = UINT64_MAX;

/// A file that was opened to be read, or why it was not.
struct OpenedInput {
  UniqueFd fd;  ///< At the file's begin.
  std::uint64_t size_bytes{};
  std::string refusal;  ///< Empty where the file is open: "is a folder, no regular file".
  int error{};          ///< What the system said; 0: the file is open, or the refusal is the bench's own.
};

/// Opens a file of a user: the only place where the bench does so. Regular files alone are taken; a FIFO, a
/// device, a folder or a socket is refused by what it is, and a FIFO without a writer is not waited for. What
/// was opened is what is looked at, so that nothing can take its place in between. A file that has more
/// bytes than the reader takes is refused before any is read; the holes of a sparse file count.
OpenedInput openInput(const std::filesystem::path& path, std::uint64_t most_bytes);

/// All bytes of a file, or why there are none.
struct InputContent {
  std::optional<std::string> bytes;
  std::string refusal;  ///< As that of OpenedInput.
  int error{};
};

/// Opens a file by openInput() and reads it once. What the kernel makes up while it is read, as in /proc, and
/// what grows meanwhile is held to the limit as well.
InputContent readInput(const std::filesystem::path& path, std::uint64_t most_bytes);

/// Reads all that comes on standard input, which may be a pipe or a terminal, within the same limit.
InputContent readStandardInput(std::uint64_t most_bytes);

/// Content of a file. @throws InputError "path: refusal".
std::string inputContent(const std::filesystem::path& path, std::uint64_t most_bytes);

}  // namespace kerfbench::base
