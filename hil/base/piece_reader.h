// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "hil/base/unique_fd.h"

namespace kerfbench::base {

/// Reads a file in pieces, so that its size does not matter.
class PieceReader {
 public:
  /// `what`: begins the words of an error. @throws std::system_error, and InputError
  /// for a folder, a pipe or a device.
  PieceReader(const std::filesystem::path& path, std::string what);

  /// Fills a piece, which is shorter at the end of the file alone; 0: there it is.
  /// @throws std::system_error.
  std::size_t read(std::span<char> piece);
  /// Goes on from another byte.
  void seek(std::uint64_t at);
  /// Bytes of the file when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  [[noreturn]] void fail(int error) const;

  std::string what_;
  UniqueFd fd_;
  std::uint64_t size_{};
};

/// Reads from where the reader is, at most `most` bytes, and hands them on in pieces.
void forEachPiece(PieceReader& file, std::uint64_t most, const std::function<void(std::string_view)>& take);

}  // namespace kerfbench::base
