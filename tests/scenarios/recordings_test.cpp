// SPDX-License-Identifier: Apache-2.0
// Recordings stand for their runs: replayed, repeated and read by other programs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

std::string digestOf(const std::filesystem::path& results) { return verdictOf(results).at("digest"); }

TEST(Recordings, GiveTheSameDigestRepeatedReplayedAndAtAnyNumberOfThreads) {
  const ScratchFolder scratch;
  const std::string scenario = fixture("scenarios/short-lines.yaml").string();
  const auto one = kerfbench(fmt::format("run '{}' -q --jobs 1 --pictures --results-dir '{}/one'", scenario,
                                         scratch.path().string()));
  const auto two = kerfbench(fmt::format("run '{}' -q --jobs 2 --no-pictures --results-dir '{}/two'",
                                         scenario, scratch.path().string()));
  ASSERT_EQ(one.exit_code, 0) << one.output;
  ASSERT_EQ(two.exit_code, 0) << two.output;
  const auto first = scratch.path() / "one" / "short-lines" / "latest";
  const auto second = scratch.path() / "two" / "short-lines" / "latest";
  EXPECT_EQ(digestOf(first), digestOf(second));
  // One verdict has pictures, the other has none: they are no part of the digest.
  for (const char* picture : {"machine.png", "board.png"}) {
    EXPECT_TRUE(std::filesystem::exists(first / picture)) << one.output;
    EXPECT_FALSE(std::filesystem::exists(second / picture));
  }

  const auto replay =
      kerfbench(fmt::format("replay '{}' --scenario '{}' -q --no-pictures --results-dir '{}/three'",
                            (first / "pins.vcd").string(), scenario, scratch.path().string()));
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  EXPECT_EQ(digestOf(first), digestOf(scratch.path() / "three" / "short-lines-replay" / "latest"));
}

std::string verdictOfCheck(const std::filesystem::path& results, const std::string& name) {
  const auto verdict = verdictOf(results);
  for (const auto& check : verdict.at("checks")) {
    if (check.at("name") == name) return check.at("verdict");
  }
  return "none";
}

struct Twice {
  int exit_code{};
  int replay_exit_code{};
  std::filesystem::path live;
  std::filesystem::path replayed;
};

/// Runs the scenario of that file on the fast twin, and replays its recording.
Twice runAndReplay(const std::string& file, const std::string& name, const ScratchFolder& scratch) {
  const std::string scenario = fixture("scenarios/" + file).string();
  const std::string options =
      fmt::format("--twin fast -q --no-pictures --results-dir '{}'", scratch.path().string());
  Twice twice{.live = scratch.path() / name / "latest",
              .replayed = scratch.path() / (name + "-replay") / "latest"};
  const auto run = kerfbench(fmt::format("run '{}' {}", scenario, options));
  const auto replay = kerfbench(
      fmt::format("replay '{}' --scenario '{}' {}", (twice.live / "pins.vcd").string(), scenario, options));
  twice.exit_code = run.exit_code;
  twice.replay_exit_code = replay.exit_code;
  EXPECT_EQ(replay.exit_code, run.exit_code) << run.output << replay.output;
  return twice;
}

/// The recording contains the meter's pulses as the controller got them, and the controller's reaction as
/// pins.
TEST(Recordings, OfALoopOnTheMeasuredPowerAreJudgedAlike) {
  const ScratchFolder scratch;
  const auto check = [&](const Twice& twice, int exit_code, const char* line_energy) {
    EXPECT_EQ(twice.exit_code, exit_code);
    EXPECT_EQ(digestOf(twice.live), digestOf(twice.replayed));
    EXPECT_EQ(verdictOfCheck(twice.replayed, "line_energy"), line_energy);
    EXPECT_EQ(verdictOfCheck(twice.replayed, "even_depth"), "PASS");
  };
  check(runAndReplay("native/short-lines.yaml", "short-lines-native", scratch), 0, "PASS");
  check(runAndReplay("faults/short-lines-open-loop.yaml", "fault-short-lines-open-loop", scratch), 1, "FAIL");
}

// The controller's own words are part of the recording: it stops by itself, and is not done.
TEST(Recordings, OfAStopTellTheSameReplayed) {
  const ScratchFolder scratch;
  const Twice twice = runAndReplay("faults/strip-return-slow.yaml", "fault-strip-return-slow", scratch);
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_EQ(digestOf(twice.live), digestOf(twice.replayed));
  EXPECT_EQ(verdictOfCheck(twice.live, "finish"), "FAIL");
  for (const auto& folder : {twice.live, twice.replayed}) {
    const std::string summary = verdictOf(folder).at("summary");
    EXPECT_NE(summary.find("the belt is too fast for this job"), std::string::npos) << summary;
  }
}

std::string outputOf(const std::string& command) {
  std::string output;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 65536> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), n);
  ::pclose(pipe);
  return output;
}

struct Wires {
  std::vector<std::string> names;  // Names in order of the file.
  std::vector<std::string> ids;
};

Wires wiresOf(const std::string& vcd) {
  Wires wires;
  std::istringstream lines(vcd.substr(0, vcd.find("$enddefinitions")));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword, type, width, id, name;
    if (words >> keyword >> type >> width >> id >> name && keyword == "$var") {
      wires.names.push_back(name);
      wires.ids.push_back(id);
    }
  }
  return wires;
}

std::size_t indexOf(const Wires& wires, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(wires.names, name) - wires.names.begin());
}

// Rising edges of a wire in the text of a VCD.
long risesInVcd(const std::string& vcd, const std::string& wire) {
  const Wires wires = wiresOf(vcd);
  const std::string id = wires.ids.at(indexOf(wires, wire));
  std::istringstream lines(vcd);
  long rises = 0;
  bool high = false;
  for (std::string line; std::getline(lines, line);) {
    if ((line.starts_with('0') || line.starts_with('1')) && line.substr(1) == id) {
      rises += line[0] == '1' && !high ? 1 : 0;
      high = line[0] == '1';
    }
  }
  return rises;
}

// Rising edges of a wire in sigrok's binary output: all channels, a bit each, in order of the file.
long risesInSamples(const std::string& samples, const Wires& wires, const std::string& wire) {
  const std::size_t stride = (wires.names.size() + 7) / 8;
  const std::size_t index = indexOf(wires, wire);
  long rises = 0;
  bool high = false;
  for (std::size_t i = index / 8; i < samples.size(); i += stride) {
    const bool level = ((static_cast<unsigned char>(samples[i]) >> (index % 8)) & 1U) != 0;
    rises += level && !high ? 1 : 0;
    high = level;
  }
  return rises;
}

TEST(Recordings, AreReadAlikeBySigrokAndGtkwave) {
  for (const char* program : {"sigrok-cli", "vcd2fst", "fst2vcd"}) {
    if (outputOf(fmt::format("command -v {}", program)).empty())
      GTEST_SKIP() << program << " is not installed";
  }
  const ScratchFolder scratch;
  const auto run =
      kerfbench(fmt::format("run '{}' -q --no-pictures --results-dir '{}'",
                            fixture("scenarios/short-lines.yaml").string(), scratch.path().string()));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto results = scratch.path() / "short-lines" / "latest";
  const std::string vcd = (results / "pins.vcd").string();
  const std::string fst = (scratch.path() / "pins.fst").string();
  EXPECT_EQ(outputOf(fmt::format("vcd2fst '{}' '{}' 2>&1 >/dev/null", vcd, fst)), "");
  const std::string back = outputOf(fmt::format("fst2vcd '{}'", fst));
  const Wires wires = wiresOf(outputOf(fmt::format("head -c 4000 '{}'", vcd)));
  // The sample rate is one a microsecond, though sigrok could take one a tick: no pulse is that short, and
  // samples are large.
  std::string samples = outputOf(fmt::format("sigrok-cli -I vcd:downsample=10000 -i '{}' -O binary", vcd));
  ASSERT_TRUE(samples.starts_with("META samplerate: 1000000\n"));
  samples.erase(0, samples.find('\n') + 1);
  const auto verdict = verdictOf(results);
  for (const auto& axis : verdict.at("pulses")) {
    const std::string wire = axis.at("axis").get<std::string>() + "_pul";
    const long pulses = axis.at("pulses").get<long>();
    ASSERT_GT(pulses, 1000);
    EXPECT_EQ(risesInVcd(back, wire), pulses) << "vcd2fst, " << wire;
    EXPECT_EQ(risesInSamples(samples, wires, wire), pulses) << "sigrok-cli, " << wire;
  }
}

TEST(Recordings, GiveAnotherDigestForAnotherSeed) {
  const ScratchFolder scratch;
  const std::string scenario = fixture("scenarios/short-lines.yaml").string();
  const auto one =
      kerfbench(fmt::format("run '{}' -q --twin fast --no-pictures --seed 1 --results-dir '{}/one'", scenario,
                            scratch.path().string()));
  const auto two =
      kerfbench(fmt::format("run '{}' -q --twin fast --no-pictures --seed 2 --results-dir '{}/two'", scenario,
                            scratch.path().string()));
  ASSERT_EQ(one.exit_code, 0) << one.output;
  ASSERT_EQ(two.exit_code, 0) << two.output;
  EXPECT_NE(digestOf(scratch.path() / "one" / "short-lines" / "latest"),
            digestOf(scratch.path() / "two" / "short-lines" / "latest"));
}

}  // namespace
}  // namespace kerfbench::test
