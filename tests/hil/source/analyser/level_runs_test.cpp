// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/level_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace kerfbench::source {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<LevelRun> packed(SamplePacker& packer, const std::vector<std::uint8_t>& samples,
                             std::size_t sample_bytes) {
  std::vector<LevelRun> runs;
  packer.add(samples, sample_bytes, runs);
  return runs;
}

TEST(SamplePacker, PicksChannelsInTheOrderAskedFor) {
  SamplePacker packer({7, 0});
  EXPECT_THAT(packed(packer, {0x80, 0x80, 0x01, 0x81, 0x00}, 1),
              ElementsAre(LevelRun{2, 0b01}, LevelRun{1, 0b10}, LevelRun{1, 0b11}, LevelRun{1, 0}));
}

TEST(SamplePacker, OtherChannelsMakeNoRuns) {
  SamplePacker packer({0});
  EXPECT_THAT(packed(packer, {0x00, 0xF0, 0x0E, 0xFE, 0x01}, 1), ElementsAre(LevelRun{4, 0}, LevelRun{1, 1}));
}

TEST(SamplePacker, TakesWideSamplesAndGoesOnFromCallToCall) {
  SamplePacker packer({17, 3});
  EXPECT_THAT(packed(packer, {0, 0, 2, 8, 0, 2}, 3), ElementsAre(LevelRun{1, 0b01}, LevelRun{1, 0b11}));
  EXPECT_THAT(packed(packer, {8, 0, 2, 0, 0, 0}, 3), ElementsAre(LevelRun{1, 0b11}, LevelRun{1, 0}));
  EXPECT_THAT(packed(packer, {}, 3), IsEmpty());
}

/// Runs of channel 3 (and 0) of the samples, one sample after the other, across all calls.
std::vector<LevelRun> oneByOne(const std::vector<std::uint8_t>& samples, std::size_t sample_bytes) {
  std::vector<LevelRun> runs;
  for (std::size_t at = 0; at < samples.size(); at += sample_bytes) {
    const std::uint32_t levels = (samples[at] >> 3U & 1U) | (samples[at + sample_bytes - 1] >> 6U & 1U) << 1U;
    if (runs.empty() || runs.back().levels != levels) runs.push_back({0, levels});
    ++runs.back().samples;
  }
  return runs;
}

TEST(SamplePacker, FindsEachChangeWhereverItIsInAWord) {
  std::uint64_t state = 5;
  const auto random = [&state](std::uint64_t below) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state >> 33U) % below;
  };
  for (const std::size_t bytes : {1U, 2U, 3U, 4U, 8U}) {
    std::vector<std::uint8_t> samples(bytes * 5000);
    for (std::size_t at = bytes; at < samples.size(); ++at)
      samples[at] = random(3) == 0 ? static_cast<std::uint8_t>(random(256)) : samples[at - bytes];
    SamplePacker packer({3, static_cast<unsigned>(8 * bytes - 2)});
    std::vector<LevelRun> all;
    for (std::size_t at = 0; at < samples.size();) {
      const std::size_t size = std::min(samples.size() - at, bytes * random(40));
      std::vector<LevelRun> runs;
      packer.add(std::span(samples).subspan(at, size), bytes, runs);
      for (const LevelRun& run : runs) {
        if (all.empty() || all.back().levels != run.levels) all.push_back({0, run.levels});
        all.back().samples += run.samples;
      }
      at += size;
    }
    EXPECT_EQ(all, oneByOne(samples, bytes)) << bytes;
  }
}

TEST(SamplePacker, RefusesWhatIsNoWholeNumberOfSamples) {
  SamplePacker packer({9});
  EXPECT_THROW(packed(packer, {1, 2, 3}, 2), std::invalid_argument);
  EXPECT_THROW(packed(packer, {1}, 1), std::invalid_argument) << "channel 9 is in no byte";
  EXPECT_THROW(packed(packer, {1}, 0), std::invalid_argument);
  EXPECT_THROW(packed(packer, std::vector<std::uint8_t>(9), 9), std::invalid_argument);
  EXPECT_THROW(SamplePacker(std::vector<unsigned>(33)), std::invalid_argument);
}

struct Heard {
  std::vector<LevelRun> runs;
  Listener::State state{};
};
Heard heard(const ListenFor& listen, const std::vector<std::vector<LevelRun>>& packets) {
  Listener listener(listen);
  Heard heard;
  std::uint64_t samples = 0;
  for (std::vector<LevelRun> runs : packets) {
    heard.state = listener.add(runs);
    for (const LevelRun& run : runs) samples += run.samples;
    heard.runs.insert(heard.runs.end(), runs.begin(), runs.end());
  }
  EXPECT_EQ(listener.samples(), samples);
  return heard;
}

TEST(Listener, WaitsForTheFirstEdgeAndThenForQuiet) {
  const Heard all = heard({10, 1000}, {{{50, 0}, {3, 1}, {9, 0}, {1, 1}}, {{9, 1}, {9, 1}}, {{5, 0}}});
  EXPECT_EQ(all.state, Listener::State::kQuiet);
  EXPECT_THAT(all.runs,
              ElementsAre(LevelRun{50, 0}, LevelRun{3, 1}, LevelRun{9, 0}, LevelRun{1, 1}, LevelRun{9, 1}));
}

TEST(Listener, EndsAtTheLimitToTheSample) {
  const Heard all = heard({10, 20}, {{{15, 0}, {4, 1}, {9, 0}}, {{1, 1}}});
  EXPECT_EQ(all.state, Listener::State::kLimit);
  EXPECT_THAT(all.runs, ElementsAre(LevelRun{15, 0}, LevelRun{4, 1}, LevelRun{1, 0}));
  EXPECT_EQ(heard({10, 1000}, {{{999, 0}}}).state, Listener::State::kListening);
  EXPECT_EQ(heard({10, 1000}, {{{1000, 0}}}).state, Listener::State::kLimit);
}

TEST(Listener, QuietThatIsOverWithTheLimitIsQuiet) {
  EXPECT_EQ(heard({10, 20}, {{{10, 0}, {50, 1}}}).state, Listener::State::kQuiet);
}

}  // namespace
}  // namespace kerfbench::source
