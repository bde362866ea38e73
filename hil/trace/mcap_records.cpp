// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/mcap_records.h"

#include <zlib.h>
#include <zstd.h>

#include <fmt/format.h>

namespace kerfbench::trace {
namespace {

// A chunk of ours holds about a megabyte. A file that claims more than this for one was made to take memory,
// which is taken before the first byte of it is unpacked.
constexpr std::uint64_t kMostChunk_bytes = std::uint64_t{256} << 20U;

}  // namespace

void McapBytes::textMap(const std::map<std::string, std::string>& map) {
  McapBytes pairs;
  for (const auto& [key, value] : map) {
    pairs.text(key);
    pairs.text(value);
  }
  text(pairs.bytes());
}

void McapBytes::put64(std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i) bytes_.at(at + i) = static_cast<char>(value >> 8U * i & 0xFFU);
}

std::string_view McapCursor::raw(std::uint64_t size) {
  if (size > left_.size())
    throw McapError(fmt::format("{} bytes are announced, and {} are there", size, left_.size()));
  const std::string_view taken = left_.substr(0, size);
  left_.remove_prefix(size);
  return taken;
}

std::uint64_t McapCursor::number(std::size_t size) {
  const std::string_view bytes = raw(size);
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8U | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

std::map<std::string, std::string> McapCursor::textMap() {
  McapCursor pairs(text());
  std::map<std::string, std::string> map;
  while (!pairs.atEnd()) {
    const std::string_view key = pairs.text();
    map.insert_or_assign(std::string(key), std::string(pairs.text()));
  }
  return map;
}

std::uint32_t mcapCrc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

McapMessage readMcapMessage(std::string_view content) {
  McapCursor cursor(content);
  McapMessage message;
  message.channel = cursor.u16();
  message.sequence = cursor.u32();
  message.log_time_ns = cursor.u64();
  cursor.u64();  // The time of publishing, which is the same.
  message.data = cursor.left();
  return message;
}

std::string chunkRecords(std::string_view content) {
  McapCursor cursor(content);
  cursor.u64();
  cursor.u64();
  const std::uint64_t size = cursor.u64();
  const std::uint32_t crc = cursor.u32();
  const std::string_view compression = cursor.text();
  const std::string_view packed = cursor.raw(cursor.u64());
  if (size > kMostChunk_bytes) throw McapError(fmt::format("a chunk of {} bytes", size));
  std::string records;
  if (compression.empty()) {
    records = packed;
  } else if (compression == "zstd") {
    records.resize(size);
    const std::size_t got = ZSTD_decompress(records.data(), size, packed.data(), packed.size());
    if (ZSTD_isError(got) != 0U)
      throw McapError(fmt::format("a chunk cannot be unpacked: {}", ZSTD_getErrorName(got)));
    records.resize(got);
  } else {
    throw McapError(fmt::format("a chunk is compressed by {}, which is not read here", compression));
  }
  if (records.size() != size)
    throw McapError(fmt::format("a chunk of {} bytes is to have {}", records.size(), size));
  if (crc != 0 && mcapCrc(records) != crc) throw McapError("the CRC of a chunk is wrong");
  return records;
}

}  // namespace kerfbench::trace
