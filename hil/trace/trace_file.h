// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "hil/trace/mcap_writer.h"
#include "hil/trace/topics.h"

namespace kerfbench::trace {

/// A trace in the making: topics and metadata at its beginning, a chunk for each group.
class TraceFile {
 public:
  /// @throws std::system_error with the path, as the others.
  TraceFile(std::filesystem::path path, const std::map<std::string, std::string>& run);

  /// The machine is on the disk when it returns: whatever cuts the file off, what is left of it can be shown.
  void add(Topic topic, std::uint64_t log_time_ns, std::string_view json);
  /// Appends what a group has.
  void flush(TopicGroup group);
  /// Appends what a group has, if it holds more than finishedChunk_s() or
  /// kFullChunk_bytes (kFullCameraChunk_bytes).
  void flushIfFull(TopicGroup group);
  void addMetadata(const std::string& name, const std::map<std::string, std::string>& values);
  void addAttachment(const std::string& name, const std::string& media_type, std::string_view data);
  /// The rest, and the end.
  void close();

  [[nodiscard]] const std::filesystem::path& path() const { return writer_.path(); }
  [[nodiscard]] std::uint64_t bytes() const { return writer_.bytes(); }

  static constexpr std::size_t kFullChunk_bytes = std::size_t{1} << 20U;
  /// Pictures are large, and one of them is looked at.
  static constexpr std::size_t kFullCameraChunk_bytes = std::size_t{1} << 18U;

 private:
  McapChunk& chunkOf(TopicGroup group) { return chunks_.at(static_cast<std::size_t>(group)); }
  McapWriter writer_;
  std::array<McapChunk, kTopicGroups> chunks_;
  std::array<std::uint64_t, kTopicGroups> last_ns_{};
};

/// What a trace says of itself.
struct TraceInfo {
  std::uint64_t bytes{};
  std::uint64_t cut_off_bytes{};  ///< At the end, of no whole record.
  bool whole{};                   ///< The file has its end.
  std::string library;
  std::size_t chunks{};
  double first_s{}, last_s{};  ///< Times of the first and the last message.
  struct TopicCount {
    std::string topic, schema;
    std::uint64_t messages{}, bytes{};
  };
  std::vector<TopicCount> topics;  ///< Topics that have messages, by id.
  std::map<std::string, std::map<std::string, std::string>> metadata;
  std::vector<std::string> attachments;  ///< Names.
  std::vector<std::string> problems;     ///< Sentences: chunks with a wrong CRC and the like.
};

/// Reads all of a trace, or of any other MCAP file, and checks each chunk.
/// @throws std::system_error, McapError if it is none.
TraceInfo traceInfo(const std::filesystem::path& path);

/// Times of a part of a trace.
struct TraceSpan {
  double from_s{0.0};
  double to_s{std::numeric_limits<double>::infinity()};
};

/// What came of a copy.
struct Copied {
  std::uint64_t messages{};
  std::vector<std::string> problems{};  ///< Sentences: chunks that were left out, and why.
};

/// Copies the messages of a trace of ours into another: all whole chunks, also of one that was cut off (a run
/// that was killed, a disk that was full), or those of a part. Chunks are made anew, of finishedChunk_s();
/// metadata and attachments go along. Of a part: the machine, the checks, all messages that hold anything of
/// it, and the line of the program before. A chunk that is not sound is left out. @throws std::system_error,
/// McapError if it is no MCAP file.
Copied copyMessages(const std::filesystem::path& from, TraceFile& to, const TraceSpan& span = {});
/// The metadata "run" of a trace. @throws as copyMessages(), McapError if there is none.
std::map<std::string, std::string> runMetadata(const std::filesystem::path& path);

/// Makes a whole file of a trace that was cut off, or of a part of one. `to` is there whole or not at all.
/// @throws as copyMessages(), base::InputError where both are one file.
Copied rewriteTrace(const std::filesystem::path& from, const std::filesystem::path& to,
                    const TraceSpan& span = {});

}  // namespace kerfbench::trace
