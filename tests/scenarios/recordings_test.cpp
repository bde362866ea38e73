// SPDX-License-Identifier: Apache-2.0
// The recording of a run is the run: replayed, repeated and read by other people's programs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

std::string digestOf(const std::filesystem::path& results) { return verdictOf(results).at("digest"); }

TEST(Recordings, GiveTheSameDigestRepeatedReplayedAndAtAnyNumberOfThreads) {
  const ScratchFolder scratch;
  const std::string scenario = fixture("scenarios/label-on-belt.yaml").string();
  const auto one = kerfbench(
      fmt::format("run '{}' -q --jobs 1 --results-dir '{}/one'", scenario, scratch.path().string()));
  const auto two = kerfbench(
      fmt::format("run '{}' -q --jobs 2 --results-dir '{}/two'", scenario, scratch.path().string()));
  ASSERT_EQ(one.exit_code, 0) << one.output;
  ASSERT_EQ(two.exit_code, 0) << two.output;
  const auto first = scratch.path() / "one" / "label-on-belt";
  EXPECT_EQ(digestOf(first), digestOf(scratch.path() / "two" / "label-on-belt"));

  const auto replay =
      kerfbench(fmt::format("replay '{}' --scenario '{}' -q --results-dir '{}/three'",
                            (first / "pins.vcd").string(), scenario, scratch.path().string()));
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  EXPECT_EQ(digestOf(first), digestOf(scratch.path() / "three" / "label-on-belt-replay"));
}

TEST(Recordings, GiveAnotherDigestForAnotherSeed) {
  const ScratchFolder scratch;
  const std::string scenario = fixture("scenarios/label-on-belt.yaml").string();
  const auto one = kerfbench(
      fmt::format("run '{}' -q --seed 1 --results-dir '{}/one'", scenario, scratch.path().string()));
  const auto two = kerfbench(
      fmt::format("run '{}' -q --seed 2 --results-dir '{}/two'", scenario, scratch.path().string()));
  ASSERT_EQ(one.exit_code, 0) << one.output;
  ASSERT_EQ(two.exit_code, 0) << two.output;
  EXPECT_NE(digestOf(scratch.path() / "one" / "label-on-belt"),
            digestOf(scratch.path() / "two" / "label-on-belt"));
}

}  // namespace
}  // namespace kerfbench::test
