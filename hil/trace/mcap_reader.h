// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "hil/base/unique_fd.h"
#include "hil/trace/mcap_records.h"

namespace kerfbench::trace {

/// Reads the records of an MCAP file in their order, whole or cut off, also while it is written.
class McapReader {
 public:
  struct Record {
    McapOp op{};
    std::uint64_t offset{};    ///< Where it begins in the file.
    std::string_view content;  ///< Valid until the next call.
  };

  /// @throws std::system_error with the path; McapError for a file that does not begin as MCAP does.
  explicit McapReader(std::filesystem::path path);

  /// The next whole record; nullopt at the end of the file. A chunk is announced with its sum unchecked.
  /// @throws std::system_error.
  std::optional<Record> next();
  /// After next() had none: bytes at the end that make no whole record; 0: none.
  [[nodiscard]] std::uint64_t cutOff_bytes() const { return size_ - position_; }
  /// Bytes of the file when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  void read(std::uint64_t offset, std::size_t size, std::string& into) const;

  std::filesystem::path path_;
  base::UniqueFd fd_;
  std::uint64_t size_{}, position_{};
  std::string head_, content_;
};

/// What the records of a file say of what is in it, as far as they were read.
class McapDirectory {
 public:
  /// Takes note of a schema or a channel, also of one in a chunk. @throws McapError.
  void take(McapOp op, std::string_view content);
  [[nodiscard]] const std::map<std::uint16_t, McapSchema>& schemas() const { return schemas_; }
  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const { return channels_; }

 private:
  std::map<std::uint16_t, McapSchema> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
};

/// Metadata or attachment as it lies in its record. @throws McapError.
struct McapMetadata {
  std::string name;
  std::map<std::string, std::string> values;
};
McapMetadata readMcapMetadata(std::string_view content);
struct McapAttachment {
  std::uint64_t log_time_ns{};
  std::string name, media_type, data;
};
McapAttachment readMcapAttachment(std::string_view content);

}  // namespace kerfbench::trace
