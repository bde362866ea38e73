// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/trace_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/base/version.h"
#include "hil/trace/mcap_reader.h"

namespace kerfbench::trace {
namespace {

namespace fs = std::filesystem;

double seconds(std::uint64_t time_ns) { return 1e-9 * static_cast<double>(time_ns); }

std::map<std::string, std::string> withVersion(std::map<std::string, std::string> run) {
  run.emplace("version", base::version());
  return run;
}

/// Longest time from a message's log_time to the end of what it holds.
double spanOf_s(Topic topic) {
  switch (topic) {
    case Topic::kBurnt:
      return kBurntSpan_s;
    case Topic::kOverview100ms:
    case Topic::kOverview1s:
    case Topic::kOverview10s:
    case Topic::kOverview100s:
      return kOverviewRows * kOverviewSteps_s.at(static_cast<std::size_t>(topic) -
                                                 static_cast<std::size_t>(Topic::kOverview100ms));
    case Topic::kMotion:
    case Topic::kPins:
    case Topic::kCommanded:
    case Topic::kGcode:
    case Topic::kSpot:
      return kBatch_s;
    case Topic::kMachine:
    case Topic::kUart:
    case Topic::kFrames:
    case Topic::kChecks:
      return 0.0;
  }
  return 0.0;
}

bool isWithin(Topic topic, double time_s, const TraceSpan& span) {
  // What is sent once, and what says where the run stands before the first edge of a part.
  if (topic == Topic::kMachine || topic == Topic::kChecks) return true;
  return time_s <= span.to_s && time_s + spanOf_s(topic) >= span.from_s;
}

/// Takes the messages of a chunk.
class Copier {
 public:
  Copier(TraceFile& to, const TraceSpan& span) : to_(to), span_(span) {}

  void take(const McapReader::Record& record) {
    switch (record.op) {
      case McapOp::kSchema:
      case McapOp::kChannel:
        directory_.take(record.op, record.content);
        break;
      case McapOp::kMetadata: {
        const McapMetadata metadata = readMcapMetadata(record.content);
        if (metadata.name != "run") to_.addMetadata(metadata.name, metadata.values);
        break;
      }
      case McapOp::kAttachment: {
        const McapAttachment attachment = readMcapAttachment(record.content);
        to_.addAttachment(attachment.name, attachment.media_type, attachment.data);
        break;
      }
      case McapOp::kChunk:
        chunk(chunkRecords(record.content));
        break;
      default:
        break;
    }
  }
  /// What holds on from before a part: the line that the head was on.
  void end() {
    if (line_before_.empty()) return;
    to_.add(Topic::kGcode, line_before_ns_, line_before_);
    ++messages_;
  }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  void keepIfBefore(Topic topic, const McapMessage& message) {
    if (topic != Topic::kGcode || seconds(message.log_time_ns) > span_.from_s) return;
    line_before_ = message.data;
    line_before_ns_ = message.log_time_ns;
  }

  /// All of it or nothing: what cannot be understood is found before anything is copied.
  void chunk(const std::string& records) {
    struct Taken {
      Topic topic{};
      McapMessage message;
    };
    std::vector<Taken> taken;
    forEachRecord(records, [&](McapOp op, std::string_view content) {
      if (op == McapOp::kSchema || op == McapOp::kChannel) directory_.take(op, content);
      if (op != McapOp::kMessage) return;
      const McapMessage message = readMcapMessage(content);
      const auto channel = directory_.channels().find(message.channel);
      if (channel == directory_.channels().end()) throw McapError("a message of an unknown channel");
      const std::optional<Topic> topic = topicNamed(channel->second.topic);
      if (!topic) throw McapError(fmt::format("{} is no topic of kerfbench", channel->second.topic));
      if (!isWithin(*topic, seconds(message.log_time_ns), span_)) return keepIfBefore(*topic, message);
      taken.push_back({*topic, message});
    });
    for (const auto& [topic, message] : taken) to_.add(topic, message.log_time_ns, message.data);
    messages_ += taken.size();
    if (!taken.empty()) to_.flushIfFull(groupOf(taken.back().topic));
  }

  TraceFile& to_;
  TraceSpan span_;
  McapDirectory directory_;
  std::uint64_t messages_{};
  std::string line_before_;
  std::uint64_t line_before_ns_{};
};

}  // namespace

TraceFile::TraceFile(fs::path path, const std::map<std::string, std::string>& run)
    : writer_(std::move(path), std::string("kerfbench ") + base::version()) {
  writer_.addMetadata("run", withVersion(run));
  addTopics(writer_);
}

void TraceFile::add(Topic topic, std::uint64_t log_time_ns, std::string_view json) {
  chunkOf(groupOf(topic)).add(channelOf(topic), log_time_ns, json);
  last_ns_.at(static_cast<std::size_t>(groupOf(topic))) = log_time_ns;
  if (topic == Topic::kMachine) flush(TopicGroup::kMachine);
}

void TraceFile::flush(TopicGroup group) { writer_.write(chunkOf(group)); }

void TraceFile::flushIfFull(TopicGroup group) {
  const McapChunk& chunk = chunkOf(group);
  if (chunk.empty()) return;
  const double held_s = seconds(last_ns_.at(static_cast<std::size_t>(group))) - seconds(chunk.firstTime_ns());
  const std::size_t full_bytes = group == TopicGroup::kCamera ? kFullCameraChunk_bytes : kFullChunk_bytes;
  if (held_s >= finishedChunk_s(group) || chunk.size() >= full_bytes) flush(group);
}

void TraceFile::addMetadata(const std::string& name, const std::map<std::string, std::string>& values) {
  writer_.addMetadata(name, values);
}

void TraceFile::addAttachment(const std::string& name, const std::string& media_type, std::string_view data) {
  writer_.addAttachment(name, media_type, data, 0);
}

void TraceFile::close() {
  for (McapChunk& chunk : chunks_) writer_.write(chunk);
  writer_.close();
}

TraceInfo traceInfo(const fs::path& path) {
  McapReader reader(path);
  TraceInfo info;
  info.bytes = reader.size();
  McapDirectory directory;
  std::map<std::uint16_t, TraceInfo::TopicCount> counts;
  double first_s = std::numeric_limits<double>::infinity();
  const auto message = [&](std::string_view content) {
    const McapMessage read = readMcapMessage(content);
    TraceInfo::TopicCount& count = counts[read.channel];
    ++count.messages;
    count.bytes += read.data.size();
    first_s = std::min(first_s, seconds(read.log_time_ns));
    info.last_s = std::max(info.last_s, seconds(read.log_time_ns));
  };
  const auto within = [&](McapOp op, std::string_view content) {
    if (op == McapOp::kSchema || op == McapOp::kChannel) directory.take(op, content);
    if (op == McapOp::kMessage) message(content);
  };
  while (const auto record = reader.next()) {
    try {
      within(record->op, record->content);
      if (record->op == McapOp::kHeader) {
        McapCursor cursor(record->content);
        cursor.text();
        info.library = cursor.text();
      } else if (record->op == McapOp::kChunk) {
        ++info.chunks;
        forEachRecord(chunkRecords(record->content), within);
      } else if (record->op == McapOp::kMetadata) {
        const McapMetadata metadata = readMcapMetadata(record->content);
        info.metadata.insert_or_assign(metadata.name, metadata.values);
      } else if (record->op == McapOp::kAttachment) {
        info.attachments.push_back(readMcapAttachment(record->content).name);
      } else if (record->op == McapOp::kFooter) {
        info.whole = true;
      }
    } catch (const McapError& e) {
      info.problems.push_back(fmt::format("at byte {}: {}", record->offset, e.what()));
    }
  }
  info.cut_off_bytes = reader.cutOff_bytes();
  info.whole = info.whole && info.cut_off_bytes == 0;
  if (std::isfinite(first_s)) info.first_s = first_s;
  for (auto& [id, count] : counts) {
    if (const auto channel = directory.channels().find(id); channel != directory.channels().end()) {
      count.topic = channel->second.topic;
      if (const auto schema = directory.schemas().find(channel->second.schema);
          schema != directory.schemas().end())
        count.schema = schema->second.name;
    }
    info.topics.push_back(count);
  }
  return info;
}

std::map<std::string, std::string> runMetadata(const fs::path& path) {
  McapReader reader(path);
  while (const auto record = reader.next()) {
    if (record->op == McapOp::kChunk) break;
    if (record->op != McapOp::kMetadata) continue;
    McapMetadata metadata = readMcapMetadata(record->content);
    if (metadata.name == "run") return metadata.values;
  }
  throw McapError(fmt::format("{} is no trace of kerfbench: it does not tell its run", path.string()));
}

Copied copyMessages(const fs::path& from, TraceFile& to, const TraceSpan& span) {
  McapReader reader(from);
  Copier copier(to, span);
  Copied copied;
  while (const auto record = reader.next()) {
    try {
      copier.take(*record);
    } catch (const McapError& e) {
      copied.problems.push_back(fmt::format("at byte {}: {}", record->offset, e.what()));
    }
  }
  copier.end();
  copied.messages = copier.messages();
  return copied;
}

Copied rewriteTrace(const fs::path& from, const fs::path& to, const TraceSpan& span) {
  std::error_code ignored;
  if (fs::equivalent(from, to, ignored))
    throw base::InputError(fmt::format("{} cannot be read and written at once", from.string()));
  const auto run = runMetadata(from);
  const fs::path fresh = to.string() + ".part";
  TraceFile file(fresh, run);
  Copied copied = copyMessages(from, file, span);
  file.close();
  fs::rename(fresh, to);
  return copied;
}

}  // namespace kerfbench::trace
