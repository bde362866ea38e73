// SPDX-License-Identifier: Apache-2.0
// Recordings that are larger than what a recording may take of the memory.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "tests/hil/source/vcd_sample.h"

#if defined(__SANITIZE_ADDRESS__)
#define KERFBENCH_MEMORY_IS_WATCHED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define KERFBENCH_MEMORY_IS_WATCHED
#endif
#endif

namespace kerfbench::source {
namespace {

class LargeVcd : public VcdTest {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_ = file("large.vcd");
};

constexpr auto kOutputs = static_cast<std::size_t>(Signal::kEncoderA);

/// PUL and gate by turns, each at a tick of its own.
PinRecording edges(std::size_t count) {
  PinRecording recording;
  std::uint16_t pul = 0;
  std::uint16_t gate = 0;
  for (Tick tick = 1; tick <= count; ++tick) {
    if (tick % 3 != 0) {
      pul ^= 1U;
      recording.outputs.push_back({100 * tick, 0, 1, pul, 0});
    } else {
      gate ^= 4U;
      recording.outputs.push_back({100 * tick, 2, 4, gate, 0});
    }
    if (tick % 5 == 0) recording.sensors.push_back({100 * tick + 1, Signal::kEncoderA, tick % 10 == 5});
  }
  recording.end = 100 * count + 100;
  return recording;
}

/// Beyond the memory once; events that are spilled several times are PinEvents' own tests and the long one's.
TEST_F(LargeVcd, ReadsBackToTheSameEvents) {
  const PinRecording recording = edges(2'200'000);
  ASSERT_GT(recording.outputs.bytes(), base::SpilledBytes::kInMemory);
  ASSERT_GT(recording.sensors.size() * sizeof(SensorEdge), base::SpilledBytes::kInMemory);
  const std::string sum = writeVcd(path_, recording, sampleMap());
  const PinRecording back = readVcd(path_, sampleMap());
  EXPECT_EQ(back.outputs, recording.outputs);
  EXPECT_TRUE(sameSensors(back.sensors, recording.sensors));
  EXPECT_THAT(back.problems, ::testing::IsEmpty());
  EXPECT_EQ(vcdSum(path_), sum);
}

TEST_F(LargeVcd, OneByteThatChangedIsFoundWhereverItIs) {
  writeVcd(path_, edges(150'000), sampleMap());
  const std::string whole = contentOf(path_);
  ASSERT_GT(whole.size(), std::size_t{1} << 20U);
  for (const std::size_t at : {std::size_t{9}, whole.size() / 3, whole.size() - 200}) {
    std::string changed = whole;
    const std::size_t blank = changed.find_first_of(" \n", at);
    changed[blank] = changed[blank] == ' ' ? '\n' : ' ';  // Nothing but the sum tells.
    put("large.vcd", changed);
    EXPECT_EQ(readVcd(path_, sampleMap()).problems.size(), 1U) << at;
    EXPECT_EQ(vcdSum(path_), std::nullopt);
  }
}

long peakMegabytes() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss / 1024;
}

/// Writes a file of `stamps` times all outputs, each on a port of its own: four bytes an edge.
SignalMap writeManyEdges(const std::filesystem::path& path, std::size_t stamps) {
  SignalMap map;
  std::ofstream out(path, std::ios::binary);
  out << "$timescale 1 us $end\n";
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    if (isSensor(signal)) continue;
    map.assign(signal, {static_cast<std::uint16_t>(i), 0});
    out << "$var wire 1 " << static_cast<char>('a' + i) << " " << signalName(signal) << " $end\n";
  }
  out << "$enddefinitions $end\n";
  std::array<std::string, 2> changes;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    for (const std::size_t level : {0U, 1U})
      changes.at(level) += std::to_string(level) + static_cast<char>('a' + i) + "\n";
  }
  for (std::size_t stamp = 1; stamp <= stamps; ++stamp) out << '#' << stamp << '\n' << changes.at(stamp % 2);
  out << '#' << stamps + 1 << '\n';
  return map;
}

TEST(LargeVcdDeathTest, TwentyMillionEdgesTakeLittleMemory) {
#ifdef KERFBENCH_MEMORY_IS_WATCHED
  GTEST_SKIP() << "the sanitizer's own memory counts";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  constexpr std::size_t kStamps = 1'700'000;  // 20.4 million edges: 326 MB of events.
  constexpr long kMost_mb = 64;
  const auto read = [] {
    const std::filesystem::path folder = VcdTest::roomyFolder();
    ::setenv("TMPDIR", folder.c_str(), 1);
    const std::filesystem::path path = folder / ("kerfbench-many-" + std::to_string(::getpid()) + ".vcd");
    const SignalMap map = writeManyEdges(path, kStamps);
    const PinRecording back = readVcd(path, map);
    std::filesystem::remove(path);
    std::size_t high = 0;
    for (const PinEvent& event : back.outputs) high += event.level;
    if (back.outputs.size() != kOutputs * kStamps || high != kOutputs * kStamps / 2) std::_Exit(2);
    std::fprintf(stderr, "peak of %ld MB\n", peakMegabytes());
    std::_Exit(peakMegabytes() < kMost_mb ? 0 : 1);
  };
  EXPECT_EXIT(read(), testing::ExitedWithCode(0), "peak of");
}

}  // namespace
}  // namespace kerfbench::source
