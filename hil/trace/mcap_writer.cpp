// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/mcap_writer.h"

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>
#include <utility>

namespace kerfbench::trace {
namespace {

// Beyond 3 the time doubles for a twentieth of the size.
constexpr int kZstdLevel = 3;

[[noreturn]] void cannotWrite(const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), "cannot write " + path.string());
}

}  // namespace

struct McapWriter::Packer {
  Packer() : context(ZSTD_createCCtx()) {
    if (context == nullptr) throw std::bad_alloc();
  }
  ~Packer() { ZSTD_freeCCtx(context); }
  Packer(const Packer&) = delete;
  Packer& operator=(const Packer&) = delete;
  ZSTD_CCtx* context;
};

void McapChunk::add(std::uint16_t channel, std::uint64_t log_time_ns, std::string_view data) {
  if (empty()) first_ns_ = last_ns_ = log_time_ns;
  first_ns_ = std::min(first_ns_, log_time_ns);
  last_ns_ = std::max(last_ns_, log_time_ns);
  index_[channel].push_back({log_time_ns, records_.size()});
  records_.record(McapOp::kMessage, [&] {
    records_.u16(channel);
    records_.u32(sequences_[channel]++);
    records_.u64(log_time_ns);
    records_.u64(log_time_ns);
    records_.raw(data);
  });
}

McapWriter::McapWriter(std::filesystem::path path, std::string_view library)
    : path_(std::move(path)),
      fd_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)),
      packer_(std::make_unique<Packer>()) {
  if (!fd_.valid()) cannotWrite(path_);
  McapBytes out;
  out.raw(kMcapMagic);
  out.record(McapOp::kHeader, [&] {
    out.text("kerfbench");
    out.text(library);
  });
  append(out.bytes());
}

McapWriter::~McapWriter() = default;

void McapWriter::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) cannotWrite(path_);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    position_ += static_cast<std::uint64_t>(written);
  }
}

std::string McapWriter::compressed(std::string_view records) {
  std::string packed(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size = ZSTD_compressCCtx(packer_->context, packed.data(), packed.size(), records.data(),
                                             records.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0U) throw McapError(ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

void McapWriter::schemaRecord(McapBytes& out, std::uint16_t id, const McapSchema& schema) {
  out.record(McapOp::kSchema, [&] {
    out.u16(id);
    out.text(schema.name);
    out.text("jsonschema");
    out.text(schema.json);
  });
}

void McapWriter::channelRecord(McapBytes& out, std::uint16_t id, const McapChannel& channel) {
  out.record(McapOp::kChannel, [&] {
    out.u16(id);
    out.u16(channel.schema);
    out.text(channel.topic);
    out.text("json");
    out.textMap({});
  });
}

std::uint16_t McapWriter::addSchema(const McapSchema& schema) {
  schemas_.push_back(schema);
  const auto id = static_cast<std::uint16_t>(schemas_.size());
  McapBytes out;
  schemaRecord(out, id, schema);
  append(out.bytes());
  return id;
}

std::uint16_t McapWriter::addChannel(const McapChannel& channel) {
  channels_.push_back(channel);
  const auto id = static_cast<std::uint16_t>(channels_.size());
  McapBytes out;
  channelRecord(out, id, channel);
  append(out.bytes());
  return id;
}

void McapWriter::addMetadata(const std::string& name, const std::map<std::string, std::string>& values) {
  McapBytes out;
  out.record(McapOp::kMetadata, [&] {
    out.text(name);
    out.textMap(values);
  });
  metadata_.push_back({position_, out.size(), name});
  append(out.bytes());
}

void McapWriter::addAttachment(const std::string& name, const std::string& media_type, std::string_view data,
                               std::uint64_t log_time_ns) {
  McapBytes out;
  out.record(McapOp::kAttachment, [&] {
    out.u64(log_time_ns);
    out.u64(log_time_ns);
    out.text(name);
    out.text(media_type);
    out.u64(data.size());
    out.raw(data);
    out.u32(mcapCrc(std::string_view(out.bytes()).substr(kRecordHead_bytes)));
  });
  attachments_.push_back({position_, out.size(), log_time_ns, data.size(), name, media_type});
  append(out.bytes());
}

void McapWriter::write(McapChunk& chunk) {
  if (chunk.empty()) return;
  const std::string packed = compressed(chunk.records_.bytes());
  ChunkEntry entry{chunk.first_ns_, chunk.last_ns_, position_, 0, 0, packed.size(), chunk.size(), {}};
  McapBytes out;
  out.record(McapOp::kChunk, [&] {
    out.u64(chunk.first_ns_);
    out.u64(chunk.last_ns_);
    out.u64(chunk.size());
    out.u32(mcapCrc(chunk.records_.bytes()));
    out.text("zstd");
    out.u64(packed.size());
    out.raw(packed);
  });
  entry.length = out.size();
  for (auto& [channel, messages] : chunk.index_) {
    if (messages.empty()) continue;
    std::ranges::stable_sort(messages, {}, &McapChunk::Entry::time_ns);
    entry.index_offsets.emplace_back(channel, position_ + out.size());
    out.record(McapOp::kMessageIndex, [&, &messages = messages, channel = channel] {
      out.u16(channel);
      out.u32(static_cast<std::uint32_t>(16 * messages.size()));
      for (const McapChunk::Entry& message : messages) {
        out.u64(message.time_ns);
        out.u64(message.offset);
      }
    });
    counts_[channel] += messages.size();
    messages.clear();
  }
  entry.index_length = out.size() - entry.length;
  chunks_.push_back(std::move(entry));
  append(out.bytes());
  chunk.records_.clear();
}

void McapWriter::chunkIndexRecord(McapBytes& out, const ChunkEntry& chunk) const {
  out.record(McapOp::kChunkIndex, [&] {
    out.u64(chunk.first_ns);
    out.u64(chunk.last_ns);
    out.u64(chunk.offset);
    out.u64(chunk.length);
    out.u32(static_cast<std::uint32_t>(10 * chunk.index_offsets.size()));
    for (const auto& [channel, offset] : chunk.index_offsets) {
      out.u16(channel);
      out.u64(offset);
    }
    out.u64(chunk.index_length);
    out.text("zstd");
    out.u64(chunk.packed);
    out.u64(chunk.unpacked);
  });
}

void McapWriter::statisticsRecord(McapBytes& out) const {
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  std::uint64_t first_ns = chunks_.empty() ? 0 : std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  for (const ChunkEntry& chunk : chunks_) {
    first_ns = std::min(first_ns, chunk.first_ns);
    last_ns = std::max(last_ns, chunk.last_ns);
  }
  out.record(McapOp::kStatistics, [&] {
    out.u64(messages);
    out.u16(static_cast<std::uint16_t>(schemas_.size()));
    out.u32(static_cast<std::uint32_t>(channels_.size()));
    out.u32(static_cast<std::uint32_t>(attachments_.size()));
    out.u32(static_cast<std::uint32_t>(metadata_.size()));
    out.u32(static_cast<std::uint32_t>(chunks_.size()));
    out.u64(first_ns);
    out.u64(last_ns);
    out.u32(static_cast<std::uint32_t>(10 * counts_.size()));
    for (const auto& [channel, count] : counts_) {
      out.u16(channel);
      out.u64(count);
    }
  });
}

void McapWriter::attachmentIndexRecords(McapBytes& out) const {
  for (const AttachmentEntry& a : attachments_) {
    out.record(McapOp::kAttachmentIndex, [&] {
      for (const std::uint64_t number : {a.offset, a.length, a.time_ns, a.time_ns, a.size}) out.u64(number);
      out.text(a.name);
      out.text(a.media_type);
    });
  }
}

void McapWriter::metadataIndexRecords(McapBytes& out) const {
  for (const MetadataEntry& m : metadata_) {
    out.record(McapOp::kMetadataIndex, [&] {
      out.u64(m.offset);
      out.u64(m.length);
      out.text(m.name);
    });
  }
}

void McapWriter::summary(McapBytes& out) const {
  struct Group {
    McapOp op{};
    std::uint64_t start{}, length{};
  };
  std::vector<Group> groups;
  const auto group = [&](McapOp op, const auto& records) {
    const std::uint64_t start = out.size();
    records();
    if (out.size() > start) groups.push_back({op, position_ + start, out.size() - start});
  };
  group(McapOp::kSchema, [&] {
    for (std::size_t i = 0; i < schemas_.size(); ++i)
      schemaRecord(out, static_cast<std::uint16_t>(i + 1), schemas_[i]);
  });
  group(McapOp::kChannel, [&] {
    for (std::size_t i = 0; i < channels_.size(); ++i)
      channelRecord(out, static_cast<std::uint16_t>(i + 1), channels_[i]);
  });
  group(McapOp::kStatistics, [&] { statisticsRecord(out); });
  group(McapOp::kChunkIndex, [&] {
    for (const ChunkEntry& chunk : chunks_) chunkIndexRecord(out, chunk);
  });
  group(McapOp::kAttachmentIndex, [&] { attachmentIndexRecords(out); });
  group(McapOp::kMetadataIndex, [&] { metadataIndexRecords(out); });
  const std::uint64_t summary_start = position_;
  const std::uint64_t offsets_start = position_ + out.size();
  for (const Group& g : groups) {
    out.record(McapOp::kSummaryOffset, [&] {
      out.u8(static_cast<std::uint8_t>(g.op));
      out.u64(g.start);
      out.u64(g.length);
    });
  }
  // The sum is over all of the summary and the footer up to itself, the footer's length included.
  constexpr std::uint64_t kFooter_bytes = 8 + 8 + 4;
  out.u8(static_cast<std::uint8_t>(McapOp::kFooter));
  out.u64(kFooter_bytes);
  out.u64(summary_start);
  out.u64(offsets_start);
  out.u32(mcapCrc(out.bytes()));
}

void McapWriter::close() {
  McapBytes end;
  end.record(McapOp::kDataEnd, [&] { end.u32(0); });
  append(end.bytes());
  McapBytes out;
  summary(out);
  out.raw(kMcapMagic);
  append(out.bytes());
  if (::fsync(fd_.get()) != 0) cannotWrite(path_);
  fd_.reset();
}

}  // namespace kerfbench::trace
