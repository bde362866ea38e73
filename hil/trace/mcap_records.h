// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::trace {

// The records of the MCAP format, version 0 (https://mcap.dev/spec), as bytes.

/// First and last bytes of every file.
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};
/// A byte for the kind of a record, and eight for the length of its content.
inline constexpr std::size_t kRecordHead_bytes = 9;

/// Bytes that are no MCAP file, or not a sound one; what() says where and why.
class McapError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A text that goes on a file: numbers little-endian, texts and lists with their length before them.
class McapBytes {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  void u16(std::uint16_t value) { number(value); }
  void u32(std::uint32_t value) { number(value); }
  void u64(std::uint64_t value) { number(value); }
  void raw(std::string_view bytes) { bytes_.append(bytes); }
  void text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size()));
    raw(text);
  }
  void textMap(const std::map<std::string, std::string>& map);
  /// A record around what `content` adds.
  template <class Content>
  void record(McapOp op, Content content) {
    u8(static_cast<std::uint8_t>(op));
    const std::size_t length_at = bytes_.size();
    u64(0);
    content();
    put64(length_at, bytes_.size() - length_at - 8);
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }
  /// Puts a number in the place of one that is there.
  void put64(std::size_t at, std::uint64_t value);

 private:
  template <class Number>
  void number(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> 8U * i & 0xFFU));
  }
  std::string bytes_;
};

/// Reads what McapBytes has written. @throws McapError where the bytes end too early.
class McapCursor {
 public:
  explicit McapCursor(std::string_view bytes) : left_(bytes) {}
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::string_view raw(std::uint64_t size);
  std::string_view text() { return raw(u32()); }
  std::map<std::string, std::string> textMap();
  [[nodiscard]] std::string_view left() const { return left_; }
  [[nodiscard]] bool atEnd() const { return left_.empty(); }

 private:
  std::uint64_t number(std::size_t size);
  std::string_view left_;
};

/// CRC-32 of ISO 3309, as the format has it.
std::uint32_t mcapCrc(std::string_view bytes);

struct McapSchema {
  std::string name;
  std::string json;  ///< A JSON Schema.
};
struct McapChannel {
  std::string topic;
  std::uint16_t schema{};  ///< Id; from 1.
};

/// A message of a chunk, as it lies there.
struct McapMessage {
  std::uint16_t channel{};
  std::uint32_t sequence{};
  std::uint64_t log_time_ns{};
  std::string_view data;
};
McapMessage readMcapMessage(std::string_view content);

/// The records of a chunk, decompressed and with the right CRC. @throws McapError.
std::string chunkRecords(std::string_view content);

/// Goes through records that lie one after the other: calls `take(op, content)`.
/// @throws McapError where one is cut off.
template <class Take>
void forEachRecord(std::string_view bytes, Take take) {
  McapCursor cursor(bytes);
  while (!cursor.atEnd()) {
    const auto op = static_cast<McapOp>(cursor.u8());
    const std::uint64_t length = cursor.u64();
    take(op, cursor.raw(length));
  }
}

}  // namespace kerfbench::trace
