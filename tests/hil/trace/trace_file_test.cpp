// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/trace_file.h"

#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/trace/mcap_reader.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/base/random.h"

namespace kerfbench::trace {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMs = 1'000'000;

/// A message as it was read: topic, time, text.
struct Read {
  std::string topic;
  std::uint64_t time_ns{};
  std::string json;
  friend bool operator==(const Read&, const Read&) = default;
};

/// Messages of the whole chunks of a file, in the order in which they lie there.
std::vector<Read> messagesIn(const fs::path& path) {
  McapReader reader(path);
  McapDirectory directory;
  std::vector<Read> all;
  while (const auto record = reader.next()) {
    directory.take(record->op, record->content);
    if (record->op != McapOp::kChunk) continue;
    forEachRecord(chunkRecords(record->content), [&](McapOp op, std::string_view content) {
      if (op != McapOp::kMessage) return;
      const McapMessage message = readMcapMessage(content);
      all.push_back(
          {directory.channels().at(message.channel).topic, message.log_time_ns, std::string(message.data)});
    });
  }
  return all;
}

std::vector<Read> of(const std::string& topic, const std::vector<Read>& all) {
  std::vector<Read> some;
  std::ranges::copy_if(all, std::back_inserter(some), [&](const Read& read) { return read.topic == topic; });
  return some;
}

class TraceFileTest : public testing::Test {
 protected:
  /// A run of so many batches, as it is written while it goes on.
  [[nodiscard]] fs::path growing(int batches) const {
    const fs::path path = temp_.path() / "run.mcap.part";
    TraceFile file(path, {{"scenario", "s"}, {"version", "9.9"}});
    file.add(Topic::kMachine, 0, "{}");
    for (int i = 0; i < batches; ++i) {
      const std::uint64_t time_ns = static_cast<std::uint64_t>(i) * 20 * kMs;
      file.add(Topic::kMotion, time_ns, fmt::format("{{\"batch\":{}}}", i));
      file.add(Topic::kPins, time_ns + kMs, fmt::format("{{\"edges\":{}}}", i));
      file.flush(TopicGroup::kMotion);
      file.flush(TopicGroup::kPins);
    }
    return path;
  }
  /// Ends of the whole records of a file.
  static std::vector<std::uint64_t> endsOf(const fs::path& path) {
    McapReader reader(path);
    std::vector<std::uint64_t> ends;
    while (const auto record = reader.next())
      ends.push_back(record->offset + kRecordHead_bytes + record->content.size());
    return ends;
  }
  const base::TempFolder temp_;
};

TEST_F(TraceFileTest, WhatGrowsIsReadUpToItsLastWholeChunk) {
  const TraceInfo info = traceInfo(growing(3));
  EXPECT_FALSE(info.whole);
  EXPECT_EQ(info.cut_off_bytes, 0U);
  EXPECT_EQ(info.chunks, 7U);
  EXPECT_EQ(info.metadata.at("run").at("scenario"), "s");
  EXPECT_DOUBLE_EQ(info.last_s, 0.041);
}

TEST_F(TraceFileTest, CutOffAtAnyByteItIsRecoveredUpToTheLastWholeChunk) {
  const fs::path part = growing(4);
  const std::string bytes = base::contentOf(part);
  const std::vector<Read> all = messagesIn(part);
  const std::vector<std::uint64_t> ends = endsOf(part);
  // Before the last channel nothing can be understood.
  const std::size_t first = 1 + 1 + 11 + kTopics;
  std::set<std::uint64_t> lengths;
  for (const std::uint64_t end : ends) lengths.insert({end - 1, end, end + 1, end + kRecordHead_bytes});
  for (std::uint64_t length = 0; length < bytes.size(); length += 97) lengths.insert(length);
  for (const std::uint64_t length : lengths) {
    if (length < ends.at(first - 1) || length > bytes.size()) continue;
    const fs::path cut = temp_.write("cut.part", bytes.substr(0, length));
    const fs::path whole = temp_.path() / "whole.mcap";
    const Copied copied = rewriteTrace(cut, whole);
    EXPECT_TRUE(copied.problems.empty());
    const std::vector<Read> left = messagesIn(cut);
    ASSERT_TRUE(std::equal(left.begin(), left.end(), all.begin()));
    EXPECT_EQ(copied.messages, left.size());
    const std::vector<Read> recovered = messagesIn(whole);
    for (const char* topic : {"/machine", "/motion", "/pins"})
      ASSERT_EQ(of(topic, recovered), of(topic, left));
    ASSERT_TRUE(traceInfo(whole).whole) << length;
  }
}

TEST_F(TraceFileTest, ARecoveredTraceKeepsTheFactsOfItsRun) {
  rewriteTrace(growing(1), temp_.path() / "whole.mcap");
  EXPECT_EQ(runMetadata(temp_.path() / "whole.mcap"),
            (std::map<std::string, std::string>{{"scenario", "s"}, {"version", "9.9"}}));
}

TEST_F(TraceFileTest, ADamagedChunkIsLeftOutAndNamed) {
  const fs::path part = growing(4);
  std::string bytes = base::contentOf(part);
  const std::vector<std::uint64_t> ends = endsOf(part);
  // The chunk of /motion of the second batch: after header, metadata, schemas, channels, a chunk and an index
  // of the machine, and two of each of the first batch.
  const std::size_t record = 1 + 1 + 11 + kTopics + 2 + 4;
  bytes[ends.at(record) - 3] = static_cast<char>(bytes[ends.at(record) - 3] ^ 1);
  const fs::path bad = temp_.write("bad.part", bytes);
  EXPECT_EQ(traceInfo(bad).problems.size(), 1U);
  const Copied copied = rewriteTrace(bad, temp_.path() / "whole.mcap");
  ASSERT_EQ(copied.problems.size(), 1U);
  EXPECT_THAT(copied.problems.front(), testing::StartsWith(fmt::format("at byte {}", ends.at(record - 1))));
  const auto motion = of("/motion", messagesIn(temp_.path() / "whole.mcap"));
  ASSERT_EQ(motion.size(), 3U);
  EXPECT_EQ(motion.at(1).time_ns, 40 * kMs);
  EXPECT_EQ(of("/pins", messagesIn(temp_.path() / "whole.mcap")).size(), 4U);
}

// Whatever the bytes are: they are read or refused, and nothing else happens.
TEST_F(TraceFileTest, AnyBytesAreReadOrRefused) {
  const std::string good = base::contentOf(growing(3));
  const CounterRandom random(1, 0);
  std::uint64_t drawn = 0;
  for (std::uint64_t round = 0; round < 100; ++round) {
    std::string bytes = good;
    for (std::uint64_t k = 0; k < 1 + round % 7; ++k) {
      const auto at =
          8 + static_cast<std::size_t>(random.uniform(drawn++) * static_cast<double>(bytes.size() - 8));
      bytes[at] = static_cast<char>(random.uniform(drawn++) * 256.0);
    }
    const fs::path path = temp_.write("any", bytes);
    EXPECT_NO_THROW(traceInfo(path));
    try {
      rewriteTrace(path, temp_.path() / "whole.mcap");
      EXPECT_TRUE(traceInfo(temp_.path() / "whole.mcap").whole);
    } catch (const McapError&) {
    }
  }
}

TEST_F(TraceFileTest, APartHasAllMessagesThatHoldAnythingOfIt) {
  const fs::path part = growing(10);
  rewriteTrace(part, temp_.path() / "clip.mcap", {0.075, 0.105});
  const auto read = messagesIn(temp_.path() / "clip.mcap");
  EXPECT_EQ(of("/machine", read).size(), 1U);
  std::vector<std::uint64_t> times;
  for (const Read& motion : of("/motion", read)) times.push_back(motion.time_ns / kMs);
  EXPECT_THAT(times, testing::ElementsAre(60, 80, 100));
}

TEST_F(TraceFileTest, APartKnowsTheLineOfTheProgramThatTheHeadWasOn) {
  const fs::path path = temp_.path() / "run.mcap";
  TraceFile file(path, {});
  for (const std::uint64_t ms : {10U, 20U, 500U})
    file.add(Topic::kGcode, ms * kMs, fmt::format("{{\"at\":{}}}", ms));
  file.close();
  rewriteTrace(path, temp_.path() / "clip.mcap", {0.3, 0.4});
  EXPECT_THAT(messagesIn(temp_.path() / "clip.mcap"),
              testing::ElementsAre(Read{"/gcode", 20 * kMs, R"({"at":20})"}));
}

TEST_F(TraceFileTest, AFinishedTraceHasChunksOfASecond) {
  rewriteTrace(growing(200), temp_.path() / "whole.mcap");
  const TraceInfo info = traceInfo(temp_.path() / "whole.mcap");
  EXPECT_TRUE(info.whole);
  EXPECT_EQ(info.chunks, 1U + 2 * 4U);
  EXPECT_EQ(info.topics.at(1).messages, 200U);
}

TEST_F(TraceFileTest, BurntPathsOfAFinishedTraceLieTogetherForTwentySeconds) {
  const fs::path path = temp_.path() / "run.mcap";
  TraceFile file(path, {});
  for (std::uint64_t s = 0; s < 63; ++s) {
    file.add(Topic::kBurnt, s * 1000 * kMs, "{}");
    file.flushIfFull(TopicGroup::kBurnt);
  }
  file.close();
  EXPECT_EQ(traceInfo(path).chunks, 3U);
}

// A viewer can show nothing without the machine: a finished trace that is cut off, while it is copied or on a
// broken disk, must not have it at its end.
TEST_F(TraceFileTest, CutOffBehindItsFirstChunkAFinishedTraceStillHasTheMachine) {
  const fs::path whole = temp_.path() / "whole.mcap";
  for (const bool is_clip : {false, true}) {
    rewriteTrace(growing(400), whole, is_clip ? TraceSpan{3.0, 5.0} : TraceSpan{});
    McapReader reader(whole);
    auto record = reader.next();
    while (record && record->op != McapOp::kChunk) record = reader.next();
    ASSERT_TRUE(record);
    const std::uint64_t end = record->offset + kRecordHead_bytes + record->content.size();
    const fs::path cut = temp_.write("cut.mcap", base::contentOf(whole).substr(0, end));
    ASSERT_EQ(messagesIn(cut).size(), 1U);
    EXPECT_EQ(messagesIn(cut).front().topic, "/machine");
    rewriteTrace(cut, temp_.path() / "recovered.mcap");
    EXPECT_EQ(of("/machine", messagesIn(temp_.path() / "recovered.mcap")).size(), 1U);
  }
}

TEST_F(TraceFileTest, NoTraceIsReadAndWrittenAtOnce) {
  const fs::path part = growing(1);
  const std::string before = base::contentOf(part);
  EXPECT_THROW(rewriteTrace(part, part), base::InputError);
  EXPECT_EQ(base::contentOf(part), before);
}

TEST_F(TraceFileTest, EachTopicHasAGroupAChannelAndASchemaOfItsOwnName) {
  const fs::path path = growing(0);
  McapReader reader(path);
  McapDirectory directory;
  while (const auto record = reader.next()) directory.take(record->op, record->content);
  ASSERT_EQ(directory.channels().size(), kTopics);
  for (std::size_t i = 0; i < kTopics; ++i) {
    const auto topic = static_cast<Topic>(i);
    const McapChannel& channel = directory.channels().at(channelOf(topic));
    EXPECT_EQ(channel.topic, topicName(topic));
    EXPECT_EQ(topicNamed(channel.topic), topic);
    EXPECT_EQ(directory.schemas().at(channel.schema).json, schemaOf(topic).json);
  }
  EXPECT_EQ(topicNamed("/none"), std::nullopt);
}

}  // namespace
}  // namespace kerfbench::trace
