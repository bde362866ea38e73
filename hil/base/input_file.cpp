// SPDX-License-Identifier: Apache-2.0
#include "hil/base/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_error.h"

namespace kerfbench::base {
namespace {

std::string tooLarge(std::uint64_t bytes, std::uint64_t most_bytes) {
  return fmt::format("has {} bytes, and at most {} are read", bytes, most_bytes);
}

/// What stands in the place of a regular file; empty: that is one.
std::string kindOf(mode_t mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "is a folder, no regular file";
  if (S_ISFIFO(mode)) return "is a pipe (FIFO), no regular file";
  if (S_ISSOCK(mode)) return "is a socket, no regular file";
  return "is a device, no regular file";
}

OpenedInput refused(std::string why, int error = 0) { return {{}, 0, std::move(why), error}; }

OpenedInput notOpened(const std::filesystem::path& path, int error) {
  if (error == ENOENT) return refused("no such file", error);
  // A socket and a device without a driver cannot be opened at all; what it is, its name tells.
  struct stat status {};
  if (error == ENXIO && ::stat(path.c_str(), &status) == 0) {
    if (std::string kind = kindOf(status.st_mode); !kind.empty()) return refused(std::move(kind));
  }
  return refused("cannot be opened: " + std::generic_category().message(error), error);
}

/// Reads to the end, which need not be where the size says.
InputContent readAll(int fd, std::uint64_t size_bytes, std::uint64_t most_bytes) {
  std::string content;
  content.reserve(static_cast<std::size_t>(std::min(size_bytes, most_bytes)));
  std::array<char, std::size_t{1} << 16U> piece{};
  for (;;) {
    const ssize_t got = ::read(fd, piece.data(), piece.size());
    if (got == 0) return {std::move(content), {}, 0};
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return {std::nullopt, "cannot be read: " + std::generic_category().message(errno), errno};
    content.append(piece.data(), static_cast<std::size_t>(got));
    if (content.size() > most_bytes)
      return {std::nullopt, fmt::format("has more than the {} bytes that are read", most_bytes), 0};
  }
}

}  // namespace

OpenedInput openInput(const std::filesystem::path& path, std::uint64_t most_bytes) {
  // Without O_NONBLOCK a FIFO is waited for until somebody writes into it. A regular file does not heed it.
  UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!fd.valid()) return notOpened(path, errno);
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0) return notOpened(path, errno);
  if (std::string kind = kindOf(status.st_mode); !kind.empty()) return refused(std::move(kind));
  const auto size_bytes = static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0));
  if (size_bytes > most_bytes) return refused(tooLarge(size_bytes, most_bytes));
  return {std::move(fd), size_bytes, {}, 0};
}

InputContent readInput(const std::filesystem::path& path, std::uint64_t most_bytes) {
  OpenedInput file = openInput(path, most_bytes);
  if (!file.fd.valid()) return {std::nullopt, std::move(file.refusal), file.error};
  return readAll(file.fd.get(), file.size_bytes, most_bytes);
}

InputContent readStandardInput(std::uint64_t most_bytes) { return readAll(STDIN_FILENO, 0, most_bytes); }

std::string inputContent(const std::filesystem::path& path, std::uint64_t most_bytes) {
  InputContent content = readInput(path, most_bytes);
  if (!content.bytes) throw InputError(fmt::format("{}: {}", path.string(), content.refusal));
  return *std::move(content.bytes);
}

}  // namespace kerfbench::base
