// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {

/// Runs of the reference controller's release for another processor than the AVR, and of the known mistakes
/// in it: fixtures/scenarios/faults/NAME-FAMILY.yaml. Skipped where emulator or release could not be built.
class OtherProcessor : public testing::Test {
 protected:
  OtherProcessor(std::string family, std::string child)
      : family_(std::move(family)), child_(std::move(child)) {}
  void SetUp() override {
    const std::filesystem::path build(KERFBENCH_BINARY_DIR);
    for (const std::string& needed : {"bin/" + child_, fmt::format("firmware/controller-{}.hex", family_)}) {
      if (!std::filesystem::exists(build / needed)) GTEST_SKIP() << needed << " was not built";
    }
  }
  /// As shipped, on the twin that the scenario names.
  [[nodiscard]] ProgramRun run(const std::string& scenario) const {
    return kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}' --timing",
                                 fixture("scenarios/" + scenario + ".yaml").string(),
                                 scratch_.path().string()));
  }
  [[nodiscard]] ProgramRun runOneUnit(const std::string& scenario) const {
    return fastRunOf(scenarioWith(scenario + ".yaml", "print: {units: 1}\n", scratch_), scratch_);
  }
  void expectFailure(const ProgramRun& run, const std::string& name, const std::string& check) const {
    EXPECT_EQ(run.exit_code, 1) << run.output;
    const auto verdict = verdictOf(scratch_.path() / fmt::format("fault-{}-{}", name, family_));
    EXPECT_THAT(checksThat(verdict, "FAIL"), testing::Contains(check)) << run.output;
  }
  ScratchFolder scratch_;

 private:
  std::string family_, child_;
};

}  // namespace kerfbench::test
