// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/mcap_reader.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_file.h"

namespace kerfbench::trace {
namespace {

/// A chunk has a megabyte, an attachment a few.
constexpr std::uint64_t kLargestRecord_bytes = std::uint64_t{256} << 20U;

[[noreturn]] void cannotRead(const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), "cannot read " + path.string());
}

}  // namespace

McapReader::McapReader(std::filesystem::path path) : path_(std::move(path)) {
  base::OpenedInput file = base::openInput(path_, base::kAnySize);
  errno = file.error;
  if (file.error != 0) cannotRead(path_);
  if (!file.fd.valid()) throw McapError(fmt::format("{}: {}", path_.string(), file.refusal));
  fd_ = std::move(file.fd);
  size_ = file.size_bytes;
  if (size_ >= kMcapMagic.size()) read(0, kMcapMagic.size(), head_);
  if (head_ != kMcapMagic) throw McapError(fmt::format("{} is no MCAP file", path_.string()));
  position_ = kMcapMagic.size();
}

void McapReader::read(std::uint64_t offset, std::size_t size, std::string& into) const {
  into.resize(size);
  std::size_t got = 0;
  while (got < size) {
    const ssize_t now = ::pread(fd_.get(), into.data() + got, size - got, static_cast<off_t>(offset + got));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) cannotRead(path_);
    if (now == 0) throw McapError(fmt::format("{} became shorter while it was read", path_.string()));
    got += static_cast<std::size_t>(now);
  }
}

std::optional<McapReader::Record> McapReader::next() {
  const std::uint64_t left = size_ - position_;
  if (left < kRecordHead_bytes) {
    if (left == kMcapMagic.size()) {
      read(position_, left, head_);
      if (head_ == kMcapMagic) position_ = size_;
    }
    return std::nullopt;
  }
  read(position_, kRecordHead_bytes, head_);
  McapCursor cursor(head_);
  Record record;
  record.op = static_cast<McapOp>(cursor.u8());
  record.offset = position_;
  const std::uint64_t length = cursor.u64();
  if (length > left - kRecordHead_bytes) return std::nullopt;
  if (length > kLargestRecord_bytes)
    throw McapError(fmt::format("{}: a record of {} bytes at byte {}, and at most {} are read",
                                path_.string(), length, position_, kLargestRecord_bytes));
  read(position_ + kRecordHead_bytes, length, content_);
  record.content = content_;
  position_ += kRecordHead_bytes + length;
  return record;
}

void McapDirectory::take(McapOp op, std::string_view content) {
  McapCursor cursor(content);
  if (op == McapOp::kSchema) {
    const std::uint16_t id = cursor.u16();
    McapSchema schema{std::string(cursor.text()), {}};
    cursor.text();  // The schema's encoding.
    schema.json = cursor.text();
    schemas_.insert_or_assign(id, std::move(schema));
  } else if (op == McapOp::kChannel) {
    const std::uint16_t id = cursor.u16();
    const std::uint16_t schema = cursor.u16();
    channels_.insert_or_assign(id, McapChannel{std::string(cursor.text()), schema});
  }
}

McapMetadata readMcapMetadata(std::string_view content) {
  McapCursor cursor(content);
  std::string name(cursor.text());
  return {std::move(name), cursor.textMap()};
}

McapAttachment readMcapAttachment(std::string_view content) {
  McapCursor cursor(content);
  McapAttachment attachment;
  attachment.log_time_ns = cursor.u64();
  cursor.u64();
  attachment.name = cursor.text();
  attachment.media_type = cursor.text();
  attachment.data = cursor.raw(cursor.u64());
  const std::size_t summed = content.size() - cursor.left().size();
  const std::uint32_t crc = cursor.u32();
  if (crc != 0 && crc != mcapCrc(content.substr(0, summed)))
    throw McapError(fmt::format("the CRC of the attachment {} is wrong", attachment.name));
  return attachment;
}

}  // namespace kerfbench::trace
