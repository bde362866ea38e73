// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/determinism/twin_digest.h"

namespace kerfbench::determinism {
namespace {

using twin::Fidelity;
using twin::Preset;

class EachFidelity : public testing::TestWithParam<Fidelity> {};

TEST_P(EachFidelity, AHundredRunsLeaveTheSameBytes) {
  for (const Machine machine : {Machine::kMirrors, Machine::kGantry}) {
    const TwinRun run{machine, GetParam(), Preset::kDynamic, 7, 0.03};
    const Digest first = digestOf(run);
    ASSERT_GT(first.burnt_bytes, 0U);
    for (int i = 1; i < 100; ++i) {
      const Digest again = digestOf(run);
      ASSERT_EQ(again, first) << nameOf(run) << ", run " << i << "\n"
                              << textOf(again) << "\n"
                              << textOf(first);
    }
  }
}

TEST_P(EachFidelity, RunsInBetweenLeaveNoTrace) {
  const TwinRun run{Machine::kMirrors, GetParam(), Preset::kDynamic, 7, 0.03};
  const Digest first = digestOf(run);
  for (const Machine machine : kMachines) digestOf({machine, GetParam(), Preset::kDynamic, 3, 0.01});
  EXPECT_EQ(digestOf(run), first);
}

TEST_P(EachFidelity, AnotherSeedIsAnotherMachine) {
  for (const Machine machine : kMachines) {
    const Digest one = digestOf({machine, GetParam(), Preset::kDynamic, 1});
    const Digest two = digestOf({machine, GetParam(), Preset::kDynamic, 2});
    EXPECT_NE(one.sheet, two.sheet);
    EXPECT_NE(one.exposures, two.exposures);
    EXPECT_NE(one.sensors, two.sensors);
    EXPECT_NE(one.pose, two.pose);
  }
}

TEST_P(EachFidelity, AnIdealMachineHasNoUseForItsSeed) {
  for (const Machine machine : kMachines) {
    EXPECT_EQ(digestOf({machine, GetParam(), Preset::kIdeal, 1}),
              digestOf({machine, GetParam(), Preset::kIdeal, 2}));
  }
}

TEST_P(EachFidelity, TheRunsUseWhatTheyAreMeantToCompare) {
  for (const TwinRun& run : allRuns()) {
    if (run.fidelity != GetParam()) continue;
    const Digest digest = digestOf(run);
    EXPECT_GT(digest.burnt_bytes, 0U) << nameOf(run);
    EXPECT_GT(digest.exposure_count, 0U) << nameOf(run);
    EXPECT_GT(digest.edge_count, 100U) << nameOf(run);
    EXPECT_EQ(digest.lost_count > 0, run.machine == Machine::kMirrorsWithSteppers) << nameOf(run);
  }
}

INSTANTIATE_TEST_SUITE_P(Twin, EachFidelity, testing::Values(Fidelity::kReference, Fidelity::kFast),
                         [](const auto& instance) {
                           return instance.param == Fidelity::kReference ? "reference" : "fast";
                         });

}  // namespace
}  // namespace kerfbench::determinism
