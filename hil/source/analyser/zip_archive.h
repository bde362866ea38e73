// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace kerfbench::source {

/// A zip archive that cannot be read or written; what() has the path.
class ZipError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a zip archive, by libzip.
class ZipReader {
 public:
  /// @throws ZipError, also for an archive that contradicts itself.
  explicit ZipReader(const std::filesystem::path& path);
  ~ZipReader();
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;

  /// Names of all parts.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Bytes of a part; nullopt: there is none.
  [[nodiscard]] std::optional<std::uint64_t> sizeOf(const std::string& part) const;
  /// Hands a part on in blocks. @throws ZipError for one that is missing or damaged (checksum).
  void read(const std::string& part, const std::function<void(std::span<const std::uint8_t>)>& take) const;
  /// A whole part of at most `most` bytes. @throws ZipError as read(), and for more.
  [[nodiscard]] std::string text(const std::string& part, std::uint64_t most) const;

 private:
  struct Handle;
  std::string path_;
  std::unique_ptr<Handle> handle_;
};

/// Fills a block of a part, in order; called until all of it is there.
using ZipFill = std::function<void(std::span<std::uint8_t>)>;

/// Writes a zip archive, deflated, by libzip. Parts are asked for while it is written.
class ZipWriter {
 public:
  /// @throws ZipError.
  explicit ZipWriter(const std::filesystem::path& path);
  ~ZipWriter();  ///< Writes nothing without commit().
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  void add(const std::string& part, std::uint64_t bytes, ZipFill fill);
  void add(const std::string& part, const std::string& text);
  /// Writes all into a file next to the archive, and renames it to the archive.
  void commit();

 private:
  struct Handle;
  std::string path_;
  std::unique_ptr<Handle> handle_;
};

}  // namespace kerfbench::source
