// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/unique_fd.h"
#include "hil/trace/mcap_records.h"

namespace kerfbench::trace {

class McapWriter;

/// Messages that become one chunk. A file may have several that grow side by side.
class McapChunk {
 public:
  /// Time in ns; `data` is one JSON text.
  void add(std::uint16_t channel, std::uint64_t log_time_ns, std::string_view data);
  [[nodiscard]] bool empty() const { return records_.size() == 0; }
  [[nodiscard]] std::size_t size() const { return records_.size(); }
  [[nodiscard]] std::uint64_t firstTime_ns() const { return first_ns_; }

 private:
  friend class McapWriter;
  struct Entry {
    std::uint64_t time_ns{}, offset{};
  };
  McapBytes records_;
  std::map<std::uint16_t, std::vector<Entry>> index_;
  std::map<std::uint16_t, std::uint32_t> sequences_;  ///< Messages of this group so far, by channel.
  std::uint64_t first_ns_{}, last_ns_{};
};

/// Writes an MCAP file from its beginning to its end, record by record: at any time what is on the disk is a
/// beginning of the file, which lacks nothing but its end. Chunks are compressed with zstd. The same calls
/// make the same bytes.
///
/// Memory: an entry of some 100 bytes for each chunk until close().
class McapWriter {
 public:
  /// Makes the file, or empties it. @throws std::system_error with the path, as the others.
  McapWriter(std::filesystem::path path, std::string_view library);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Ids count from 1. Schema and channel are on the disk when it returns.
  std::uint16_t addSchema(const McapSchema& schema);
  std::uint16_t addChannel(const McapChannel& channel);
  void addMetadata(const std::string& name, const std::map<std::string, std::string>& values);
  void addAttachment(const std::string& name, const std::string& media_type, std::string_view data,
                     std::uint64_t log_time_ns);
  /// Appends a chunk with the indexes of its messages, in one write, and empties it. Nothing if it is empty.
  void write(McapChunk& chunk);
  /// Writes the summary and the end, and waits until all of it is on the disk. Once.
  void close();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::uint64_t bytes() const { return position_; }

 private:
  struct ChunkEntry {
    std::uint64_t first_ns{}, last_ns{}, offset{}, length{}, index_length{}, packed{}, unpacked{};
    std::vector<std::pair<std::uint16_t, std::uint64_t>> index_offsets;
  };
  struct AttachmentEntry {
    std::uint64_t offset{}, length{}, time_ns{}, size{};
    std::string name, media_type;
  };
  struct MetadataEntry {
    std::uint64_t offset{}, length{};
    std::string name;
  };

  void append(std::string_view bytes);
  std::string compressed(std::string_view records);
  static void schemaRecord(McapBytes& out, std::uint16_t id, const McapSchema& schema);
  static void channelRecord(McapBytes& out, std::uint16_t id, const McapChannel& channel);
  void chunkIndexRecord(McapBytes& out, const ChunkEntry& chunk) const;
  void statisticsRecord(McapBytes& out) const;
  void attachmentIndexRecords(McapBytes& out) const;
  void metadataIndexRecords(McapBytes& out) const;
  void summary(McapBytes& out) const;

  std::filesystem::path path_;
  base::UniqueFd fd_;
  std::uint64_t position_{};
  std::vector<McapSchema> schemas_;
  std::vector<McapChannel> channels_;
  std::vector<ChunkEntry> chunks_;
  std::vector<AttachmentEntry> attachments_;
  std::vector<MetadataEntry> metadata_;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< Messages by channel.
  struct Packer;
  std::unique_ptr<Packer> packer_;
};

}  // namespace kerfbench::trace
