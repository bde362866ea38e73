// SPDX-License-Identifier: Apache-2.0
// Traces of whole runs, by the program as a user gets it.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/trace/mcap_reader.h"
#include "hil/trace/run/trace_scenes.h"
#include "hil/trace/trace_file.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A message as it was read.
struct Message {
  std::uint64_t time_ns{};
  json content;
};
using Messages = std::map<std::string, std::vector<Message>>;

/// Calls with schema's name and text, topic, time and text of each message of the whole chunks of a file.
using TakeMessage = std::function<void(const trace::McapSchema& schema, const std::string& topic,
                                       std::uint64_t time_ns, std::string_view text)>;
void forEachMessage(const fs::path& path, const TakeMessage& take) {
  trace::McapReader reader(path);
  trace::McapDirectory directory;
  while (const auto record = reader.next()) {
    directory.take(record->op, record->content);
    if (record->op != trace::McapOp::kChunk) continue;
    const std::string records = trace::chunkRecords(record->content);
    trace::forEachRecord(records, [&](trace::McapOp op, std::string_view content) {
      if (op != trace::McapOp::kMessage) return;
      const trace::McapMessage message = trace::readMcapMessage(content);
      const trace::McapChannel& channel = directory.channels().at(message.channel);
      take(directory.schemas().at(channel.schema), channel.topic, message.log_time_ns, message.data);
    });
  }
}

Messages messagesIn(const fs::path& path) {
  Messages all;
  forEachMessage(path, [&](const trace::McapSchema&, const std::string& topic, std::uint64_t time_ns,
                           std::string_view text) {
    all[topic].push_back({time_ns, json::parse(text)});
  });
  return all;
}

/// A column over all messages of a topic; NaN for null.
std::vector<double> column(const Messages& messages, const std::string& topic, const std::string& name) {
  std::vector<double> values;
  for (const Message& message : messages.at(topic))
    for (const json& value : message.content.at(name))
      values.push_back(value.is_null() ? NAN : value.get<double>());
  return values;
}

/// One run that all look at: a label on the moving belt, by the native release, with two threads.
class RunTrace : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder();
    const ProgramRun run = runOf("two", "--trace --trace-frames 20 -j 2");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    output_ = run.output;
  }
  static void TearDownTestSuite() {
    delete scratch_;
    scratch_ = nullptr;
  }
  static fs::path folder(const std::string& name) { return scratch_->path() / name; }
  static fs::path traceOf(const std::string& name) { return folder(name) / trace::kTraceFile; }
  static ProgramRun runOf(const std::string& name, const std::string& options) {
    return kerfbench(fmt::format("run '{}' --no-pictures --twin fast --output '{}' {}",
                                 fixture("scenarios/native/label-on-belt.yaml").string(),
                                 folder(name).string(), options));
  }
  static const Messages& messages() {
    static const Messages all = messagesIn(traceOf("two"));
    return all;
  }
  static Messages replayOf(const fs::path& recording, const std::string& name) {
    const ProgramRun replay = kerfbench(fmt::format(
        "replay '{}' --scenario '{}' --no-pictures --twin fast --trace --output '{}' -j 2",
        recording.string(), fixture("scenarios/native/label-on-belt.yaml").string(), folder(name).string()));
    EXPECT_EQ(replay.exit_code, 0) << replay.output;
    return messagesIn(traceOf(name));
  }
  static void expectTheSameProgram(const Messages& again, const std::string& from) {
    const json& machine = again.at("/machine").front().content;
    const json& sent = messages().at("/machine").front().content;
    EXPECT_EQ(sent.at("gcode_from"), "sent");
    EXPECT_EQ(machine.at("gcode_from"), from);
    EXPECT_EQ(machine.at("gcode"), sent.at("gcode"));
    EXPECT_EQ(machine.at("period_s"), sent.at("period_s"));
    EXPECT_EQ(column(again, "/gcode", "line"), column(messages(), "/gcode", "line"));
    EXPECT_EQ(column(again, "/gcode", "t_s"), column(messages(), "/gcode", "t_s"));
  }
  static ScratchFolder* scratch_;
  static std::string output_;
};
ScratchFolder* RunTrace::scratch_ = nullptr;
std::string RunTrace::output_;

TEST_F(RunTrace, IsTheSameBytesAtAnyNumberOfThreadsAndChangesNoDigest) {
  ASSERT_EQ(runOf("one", "--trace --trace-frames 20 -j 1").exit_code, 0);
  EXPECT_TRUE(textOf(traceOf("one")) == textOf(traceOf("two")));
  ASSERT_EQ(runOf("none", "-j 2").exit_code, 0);
  EXPECT_FALSE(fs::exists(traceOf("none")));
  EXPECT_EQ(verdictOf(folder("none")).at("digest"), verdictOf(folder("two")).at("digest"));
}

TEST_F(RunTrace, IsAWholeFileInTheResultsAndNothingIsLeftBesideIt) {
  const trace::TraceInfo info = trace::traceInfo(traceOf("two"));
  EXPECT_TRUE(info.whole);
  EXPECT_THAT(info.problems, testing::IsEmpty());
  EXPECT_THAT(info.attachments, testing::ElementsAre("scenario.yaml", "job.gcode"));
  EXPECT_EQ(info.metadata.at("verdict").at("digest"), verdictOf(folder("two")).at("digest"));
  EXPECT_FALSE(fs::exists(folder("two.mcap.part")));
  EXPECT_THAT(output_, testing::HasSubstr("trace: " + folder("two").string() + ".mcap.part"));
  EXPECT_EQ(program("kerfbench", fmt::format("trace info '{}'", traceOf("two").string())).exit_code, 0);
}

TEST_F(RunTrace, EachMessageIsAsItsSchemaHasIt) {
  const fs::path at = scratch_->path() / "messages";
  fs::create_directories(at);
  std::set<std::string> topics;
  std::size_t count = 0;
  forEachMessage(traceOf("two"), [&](const trace::McapSchema& schema, const std::string& topic, std::uint64_t,
                                     std::string_view text) {
    std::ofstream(at / (schema.name + ".json")) << schema.json;
    std::ofstream(at / (schema.name + ".jsonl"), std::ios::app) << text << "\n";
    topics.insert(topic);
    ++count;
  });
  EXPECT_EQ(topics.size(), trace::kTopics);
  const std::string script = (fs::path(KERFBENCH_SOURCE_DIR) / "tests/traces/validate_messages.py").string();
  const ProgramRun valid = program("/usr/bin/python3", fmt::format("-B '{}' '{}'", script, at.string()));
  EXPECT_EQ(valid.exit_code, 0) << valid.output;
  EXPECT_THAT(valid.output, testing::HasSubstr(fmt::format("{} messages", count)));
}

TEST_F(RunTrace, TheFormatsOwnLibraryReadsItByIndexAndAsAStream) {
  const fs::path source = KERFBENCH_SOURCE_DIR;
  const ProgramRun node =
      program("/usr/bin/env",
              fmt::format("node '{}' '{}' '{}'", (source / "tests/traces/read_by_mcap_core.mjs").string(),
                          (source / "window/node_modules").string(), traceOf("two").string()));
  if (node.exit_code == 77) GTEST_SKIP() << "the window's packages are not there: " << node.output;
  ASSERT_EQ(node.exit_code, 0) << node.output;
  const json read = json::parse(node.output);
  std::map<std::string, std::size_t> ours;
  for (const auto& [topic, list] : messages()) ours[topic] = list.size();
  EXPECT_EQ(read.at("indexed"), json(ours));
  EXPECT_EQ(read.at("streamed"), json(ours));
  EXPECT_EQ(read.at("attachments"), json({"scenario.yaml", "job.gcode"}));
  EXPECT_EQ(read.at("metadata"), json({"run", "verdict"}));
}

TEST_F(RunTrace, HasARowOfMotionForEachHalfMillisecondFromBeginToEnd) {
  const std::vector<double> times = column(messages(), "/motion", "t_s");
  const double end_s = verdictOf(folder("two")).at("virtual_s").get<double>();
  ASSERT_NEAR(static_cast<double>(times.size()), end_s / 0.5e-3 + 1.0, 2.0);
  for (std::size_t i = 0; i < times.size(); ++i) ASSERT_NEAR(times[i], 0.5e-3 * static_cast<double>(i), 1e-8);
  EXPECT_EQ(column(messages(), "/commanded", "t_s"), times);
}

// The recording that was judged is the measure of the pins; it is written and read by other code.
TEST_F(RunTrace, HasThePinsOfTheRecording) {
  std::map<std::string, std::vector<std::pair<std::uint64_t, bool>>> ours, judged;
  std::map<int, std::string> names;
  for (const json& signal : messages().at("/machine").front().content.at("signals"))
    names[signal.at("id").get<int>()] = signal.at("name").get<std::string>();
  for (const Message& message : messages().at("/pins")) {
    auto tick = message.content.at("tick0").get<std::uint64_t>();
    for (std::size_t i = 0; i < message.content.at("dt").size(); ++i) {
      tick += message.content.at("dt")[i].get<std::uint64_t>();
      ours[names.at(message.content.at("id")[i].get<int>())].emplace_back(
          tick, message.content.at("level")[i] == 1);
    }
  }
  std::istringstream vcd(textOf(folder("two") / "pins.vcd"));
  std::map<std::string, std::string> codes;
  std::uint64_t stamps = 0;
  for (std::string line; std::getline(vcd, line);) {
    std::istringstream words(line);
    std::string word, type, width, code, name;
    words >> word;
    if (word == "$var" && words >> type >> width >> code >> name) codes[code] = name;
    if (word.starts_with("#")) stamps = std::stoull(word.substr(1));
    if ((word.starts_with("0") || word.starts_with("1")) && codes.contains(word.substr(1)))
      judged[codes.at(word.substr(1))].emplace_back(stamps, word[0] == '1');
  }
  ASSERT_GE(codes.size(), 8U);
  for (auto& [name, edges] : judged) {
    // What the recording says first is the level at the begin.
    bool level = false;
    std::erase_if(edges,
                  [&level](const auto& edge) { return !std::exchange(level, edge.second) == !edge.second; });
    SCOPED_TRACE(name);
    ASSERT_EQ(edges.size(), ours[name].size());
    for (std::size_t i = 0; i < edges.size(); ++i) ASSERT_EQ(edges[i].second, ours[name][i].second);
  }
  EXPECT_GT(ours["galvo_x_pul"].size(), 1000U);
}

// The beam follows its pulses and the program: what is shown at one moment belongs together.
TEST_F(RunTrace, WhatIsShownAtOneMomentBelongsTogether) {
  const std::vector<double> lit = column(messages(), "/motion", "lit");
  const std::vector<double> x = column(messages(), "/motion", "spot_x_mm"),
                            y = column(messages(), "/motion", "spot_y_mm");
  const std::vector<double> ax = column(messages(), "/commanded", "x_mm"),
                            ay = column(messages(), "/commanded", "y_mm");
  ASSERT_EQ(x.size(), ax.size());
  std::size_t cut = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (lit[i] == 0.0) continue;
    ++cut;
    // At 300 mm/s and half a millisecond behind its pulses.
    ASSERT_LT(std::hypot(x[i] - ax[i], y[i] - ay[i]), 0.4) << "row " << i;
  }
  EXPECT_GT(cut, 500U);
  const std::vector<double> lines = column(messages(), "/gcode", "line"),
                            units = column(messages(), "/gcode", "unit");
  int last_unit = -1;
  double last_line = 0.0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] == 0.0) continue;
    if (units[i] != last_unit) last_line = 0.0;
    EXPECT_GE(units[i], last_unit);
    EXPECT_GE(lines[i], last_line) << "row " << i;
    last_unit = static_cast<int>(units[i]);
    last_line = lines[i];
  }
  EXPECT_GE(last_unit, 0);
}

// A viewer that looks at a moment reads the chunk of its frame, and finds all windows of it there.
TEST_F(RunTrace, TheWindowsOfAFrameLieInOneChunkAndItIsSmall) {
  trace::McapReader reader(traceOf("two"));
  trace::McapDirectory directory;
  std::map<int, std::set<std::uint64_t>> chunks_of_frame;
  while (const auto record = reader.next()) {
    directory.take(record->op, record->content);
    if (record->op != trace::McapOp::kChunk) continue;
    const std::string records = trace::chunkRecords(record->content);
    trace::forEachRecord(records, [&](trace::McapOp op, std::string_view content) {
      if (op != trace::McapOp::kMessage) return;
      const trace::McapMessage message = trace::readMcapMessage(content);
      if (directory.channels().at(message.channel).topic != "/frames") return;
      chunks_of_frame[json::parse(message.data).at("sequence").get<int>()].insert(record->offset);
      EXPECT_LT(records.size(), 3 * trace::TraceFile::kFullCameraChunk_bytes);
    });
  }
  EXPECT_GT(chunks_of_frame.size(), 10U);
  for (const auto& [sequence, chunks] : chunks_of_frame) EXPECT_EQ(chunks.size(), 1U) << sequence;
}

TEST_F(RunTrace, TheOverviewCountsTheSameEdges) {
  std::map<int, long long> edges, overview;
  for (const Message& message : messages().at("/pins"))
    for (const json& id : message.content.at("id")) ++edges[id.get<int>()];
  for (const char* level : {"/overview/100ms", "/overview/1s", "/overview/10s", "/overview/100s"}) {
    overview.clear();
    for (const Message& message : messages().at(level))
      for (const json& pin : message.content.at("pins"))
        for (const json& count : pin.at("edges"))
          if (count != 0) overview[pin.at("id").get<int>()] += count.get<long long>();
    EXPECT_EQ(overview, edges) << level;
  }
}

TEST_F(RunTrace, AReplayHasTheSamePinsTheControllersWordsAndTheProgramBesideIt) {
  const Messages again = replayOf(folder("two") / "pins.vcd", "replay");
  EXPECT_EQ(column(again, "/pins", "dt").size(), column(messages(), "/pins", "dt").size());
  EXPECT_EQ(column(again, "/motion", "spot_x_mm").size(), column(messages(), "/motion", "spot_x_mm").size());
  expectTheSameProgram(again, "recorded");
  const auto heard = [](const Messages& all) {
    std::string hex;
    for (const Message& message : all.at("/uart"))
      if (message.content.at("name") == "controller") hex += message.content.at("hex").get<std::string>();
    return hex;
  };
  EXPECT_EQ(heard(again), heard(messages()));
}

// The program is what people look for first in the trace of a fault; a recording alone has none.
TEST_F(RunTrace, AReplayOfARecordingAloneShowsTheProgramThatIsPlannedAnew) {
  const fs::path alone = scratch_->path() / "alone" / "pins.vcd";
  fs::create_directories(alone.parent_path());
  fs::copy_file(folder("two") / "pins.vcd", alone);
  expectTheSameProgram(replayOf(alone, "planned"), "planned");
}

TEST_F(RunTrace, IsFilmedAsItsRowsHaveIt) {
  const trace::TraceScenes scenes(traceOf("two"), {3.0, 4.0});
  const std::vector<double> t_s = column(messages(), "/motion", "t_s");
  const std::vector<double> x_mm = column(messages(), "/motion", "spot_x_mm");
  const std::vector<double> lit = column(messages(), "/motion", "lit");
  std::size_t looked = 0;
  for (std::size_t i = 0; i < t_s.size(); i += 97) {
    if (t_s[i] < 3.0 || t_s[i] > 4.0 || std::isnan(x_mm[i])) continue;
    const twin::Scene scene = scenes.at(t_s[i]);
    ASSERT_FALSE(scene.beam.empty());
    EXPECT_NEAR(scene.beam.back().p_W_mm.x(), x_mm[i], 1e-6);
    EXPECT_EQ(scene.beam_on, lit[i] > 0.5);
    ++looked;
  }
  EXPECT_GT(looked, 10U);
  const auto burnt = [&](double time_s) {
    std::size_t points = 0;
    for (const auto& path : scenes.at(time_s).burnt) points += path.size();
    return points;
  };
  EXPECT_LT(burnt(3.0), burnt(3.9));
}

/// A run in the background that is killed when this ends, if it still runs.
class BackgroundRun {
 public:
  explicit BackgroundRun(const std::vector<std::string>& arguments) {
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
  }
  ~BackgroundRun() { kill(); }
  BackgroundRun(const BackgroundRun&) = delete;
  BackgroundRun& operator=(const BackgroundRun&) = delete;
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
  }

 private:
  pid_t pid_{-1};
};

std::size_t chunksIn(const fs::path& path) {
  try {
    return trace::traceInfo(path).chunks;
  } catch (const std::exception&) {
    return 0;  // The file is not there yet, or has not begun.
  }
}

TEST_F(RunTrace, KilledInMidRunItIsRecoveredUpToTheLastChunk) {
  const fs::path part = folder("killed.mcap.part");
  BackgroundRun run({(fs::path(KERFBENCH_BINARY_DIR) / "bin/kerfbench").string(), "run",
                     fixture("scenarios/native/label-on-belt.yaml").string(), "--no-pictures", "--quiet",
                     "--output", folder("killed").string(), "--trace", "-j", "1"});
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (chunksIn(part) < 20 && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
  run.kill();
  ASSERT_FALSE(fs::exists(folder("killed")));
  const Messages left = messagesIn(part);
  const ProgramRun recovery =
      program("kerfbench", fmt::format("trace recover '{}' --out '{}'", part.string(),
                                       (scratch_->path() / "recovered.mcap").string()));
  ASSERT_EQ(recovery.exit_code, 0) << recovery.output;
  const Messages recovered = messagesIn(scratch_->path() / "recovered.mcap");
  EXPECT_TRUE(trace::traceInfo(scratch_->path() / "recovered.mcap").whole);
  // All that was written whole, which is the begin of the same run, gap-free in pieces of at most 50 ms.
  const std::vector<double> times = column(recovered, "/motion", "t_s");
  EXPECT_EQ(times, column(left, "/motion", "t_s"));
  const std::vector<double> all = column(messages(), "/motion", "t_s");
  ASSERT_LE(times.size(), all.size());
  EXPECT_TRUE(std::equal(times.begin(), times.end(), all.begin()));
  EXPECT_EQ(column(recovered, "/pins", "dt").size(), column(left, "/pins", "dt").size());
  std::optional<std::uint64_t> before;
  trace::McapReader reader(part);
  while (const auto record = reader.next()) {
    if (record->op != trace::McapOp::kChunk) continue;
    trace::McapCursor cursor(record->content);
    const std::uint64_t first_ns = cursor.u64();
    if (first_ns == 0) continue;
    if (before && first_ns > *before) EXPECT_LE(first_ns - *before, 50'000'000U);
    before = std::max(before.value_or(0), first_ns);
  }
}

TEST_F(RunTrace, APartOfItShowsItsMomentToTheFormatsLibraryToo) {
  const std::string clip = (scratch_->path() / "clip.mcap").string();
  const ProgramRun cut = program("kerfbench", fmt::format("trace clip '{}' --at 1 --around 0.05 --out '{}'",
                                                          traceOf("two").string(), clip));
  ASSERT_EQ(cut.exit_code, 0) << cut.output;
  const std::vector<double> times = column(messagesIn(clip), "/motion", "t_s");
  EXPECT_LE(times.front(), 0.95);
  EXPECT_GE(times.back(), 1.05 - 1e-9);
  EXPECT_LE(times.back() - times.front(), 0.15);
}

// A trace that cannot be shown must be refused with a word, not with a crash.
TEST_F(RunTrace, WhatIsNoTraceIsRefused) {
  const fs::path none = scratch_->path() / "none.mcap";
  std::ofstream(none) << "this is text";
  for (const std::string command : {"info '{}'", "recover '{}' --out x", "clip '{}' --at 1 --out x"}) {
    const ProgramRun run = program("kerfbench", "trace " + fmt::format(fmt::runtime(command), none.string()));
    EXPECT_EQ(run.exit_code, 65) << run.output;
    EXPECT_THAT(run.output, testing::HasSubstr("no MCAP file"));
  }
}

TEST(TraceOfAFault, TheReportSaysHowToSeeEachFailingMoment) {
  const ScratchFolder scratch;
  const ProgramRun run = kerfbench(
      fmt::format("run '{}' --no-pictures --twin fast --trace --output '{}' -j 2",
                  fixture("scenarios/faults/gate-late.yaml").string(), (scratch.path() / "run").string()));
  ASSERT_EQ(run.exit_code, 1) << run.output;
  const std::string page = textOf(scratch.path() / "run/report.html");
  std::size_t shown = 0;
  const Messages messages = messagesIn(scratch.path() / "run" / trace::kTraceFile);
  for (const Message& message : messages.at("/checks")) {
    if (message.content.at("outcome") != "FAIL" || message.content.at("time_s").is_null()) continue;
    EXPECT_NEAR(1e-9 * static_cast<double>(message.time_ns), message.content.at("time_s").get<double>(),
                1e-9);
    const std::string command =
        fmt::format("kerfbench view run.mcap --at {:.6f}", message.content.at("time_s").get<double>());
    shown += page.find(command) != std::string::npos ? 1U : 0U;
  }
  EXPECT_GE(shown, 1U);
}

}  // namespace
}  // namespace kerfbench::test
