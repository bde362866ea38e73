// SPDX-License-Identifier: Apache-2.0
// What goes wrong on purpose, and ends in a safe state; and releases that do not care.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;

ProgramRun runHere(const std::string& scenario, const ScratchFolder& scratch) {
  return kerfbench(fmt::format("run '{}' --no-pictures --twin fast --results-dir '{}'",
                               fixture("scenarios/" + scenario).string(), scratch.path().string()));
}

std::string subjectOf(const nlohmann::json& verdict, const std::string& check) {
  for (const auto& one : verdict.at("checks")) {
    if (one.at("name") == check) return one.at("subject");
  }
  return "no such check";
}

struct SafeScenario {
  const char* file;    // fixtures/scenarios/safe/<file>.yaml
  const char* report;  // The fault that the controller names.
};

class SafeState : public testing::TestWithParam<SafeScenario> {};

TEST_P(SafeState, IsReachedAndTold) {
  const ScratchFolder scratch;
  const auto run = runHere(fmt::format("safe/{}.yaml", GetParam().file), scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::string name = GetParam().file;
  if (const auto slash = name.find('/'); slash != std::string::npos)
    name = name.substr(slash + 1) + "-" + name.substr(0, slash);
  const auto verdict = verdictOf(scratch.path() / ("safe-" + name));
  const auto good = checksThat(verdict, "PASS");
  EXPECT_THAT(good, testing::IsSupersetOf({"safe_state", "safe_stop", "safe_report", "pulse_timing"}));
  EXPECT_EQ(subjectOf(verdict, "safe_report"), GetParam().report);
}

INSTANTIATE_TEST_SUITE_P(
    Provoked, SafeState,
    testing::Values(SafeScenario{"interlock", "interlock"}, SafeScenario{"limit", "limit"},
                    SafeScenario{"encoder-lost", "encoder"}, SafeScenario{"encoder-wire-b", "encoder"},
                    SafeScenario{"host-silent", "silent"}, SafeScenario{"line-noise", "uart"},
                    SafeScenario{"queue-dry", "dry"}, SafeScenario{"belt-too-fast", "belt-fast"},
                    SafeScenario{"field", "field"}, SafeScenario{"print-marks", "marks"},
                    SafeScenario{"log-waits", "late"}, SafeScenario{"main-stuck", "watchdog"},
                    SafeScenario{"native/interlock", "interlock"},
                    SafeScenario{"native/encoder-lost", "encoder"},
                    SafeScenario{"native/main-stuck", "watchdog"}),
    [](const auto& instance) {
      std::string name = instance.param.file;
      std::ranges::replace_if(
          name, [](char c) { return c == '-' || c == '/'; }, '_');
      return name;
    });

class Careless : public testing::TestWithParam<const char*> {};

TEST_P(Careless, ReleaseFailsBySafeState) {
  const ScratchFolder scratch;
  const std::string name = GetParam();
  const auto run = runHere("faults/" + name + ".yaml", scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / ("fault-" + name)), "FAIL"), Contains("safe_state"));
}

INSTANTIATE_TEST_SUITE_P(Faults, Careless, testing::Values("interlock-ignored", "encoder-trusted"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace kerfbench::test
