// SPDX-License-Identifier: Apache-2.0
// Suites that were begun and not ended: killed, changed, damaged, on a full disk, wanted by two.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/batch/folder_lock.h"
#include "hil/batch/job_folder.h"
#include "tests/hil/batch/small_jobs.h"
#include "tests/hil/suite/small_suite.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class BegunSuite : public testing::Test {
 protected:
  BegunSuite() {
    for (const char* name : {"a", "b", "c"}) small_.scenario(name);
    small_.plan("runs: [{scenario: a.yaml}, {scenario: b.yaml}, {scenario: c.yaml}]\n");
  }
  /// Begins the suite and kills it, and nothing else, when the second run has begun.
  void killInTheSecondRun() const {
    const batch::NamedPipe begun(small_.folder() / "begun");
    const batch::NamedPipe never(small_.folder() / "never");
    small_.act("b", "echo > " + begun.path() + "; read never < " + never.path());
    const pid_t bench = ::fork();
    if (bench == 0) {
      (void)runQuietly(small_.options());
      ::_exit(0);
    }
    (void)begun.line();
    ASSERT_EQ(::kill(bench, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(bench, &status, 0), bench);
    small_.act("b", "");
  }
  [[nodiscard]] SuiteOptions resuming() const {
    SuiteOptions options = small_.options();
    options.resume.emplace();
    return options;
  }
  [[nodiscard]] std::string refused() const {
    return errorOf<base::InputError>([&] { return runQuietly(resuming()); });
  }
  SmallSuite small_;
};

TEST_F(BegunSuite, AKilledOneGoesOnToTheSameBytes) {
  ASSERT_EQ(runQuietly(small_.options()), 0);
  const std::string uninterrupted = small_.summaryText();
  fs::remove_all(small_.folder() / "results");
  fs::remove(small_.folder() / "bin/kerfbench.calls");
  killInTheSecondRun();
  EXPECT_EQ(small_.outcomes(), "as expected, not run, not run");
  EXPECT_EQ(runQuietly(resuming()), 0);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nb 1\nc 1\n");
  EXPECT_EQ(small_.summaryText(), uninterrupted);
  EXPECT_EQ(runQuietly(resuming()), 0);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nb 1\nc 1\n") << "nothing was left to run";
}

TEST_F(BegunSuite, WhatChangedSinceIsToldAndNothingRuns) {
  killInTheSecondRun();
  const std::string calls = small_.calls();
  small_.scenario("c", "seed: 5\n");
  EXPECT_THAT(refused(), AllOf(HasSubstr("cannot be resumed"), HasSubstr("c.yaml has changed")));
  small_.scenario("c");
  small_.put("firmware/controller-native", "another image");
  EXPECT_THAT(refused(), HasSubstr("controller-native has changed"));
  small_.put("firmware/controller-native", "an image");
  small_.plan(
      "runs: [{scenario: a.yaml}, {scenario: b.yaml, seeds: [3]}, {scenario: c.yaml, time_limit_s: 5}]\n");
  EXPECT_THAT(refused(), AllOf(HasSubstr("the plan has no run b any more"), HasSubstr("a new run b-seed-3"),
                               HasSubstr("run c has other options or files")));
  small_.plan(
      "runs: [{scenario: a.yaml}, {scenario: b.yaml}, {scenario: c.yaml, expect: FAIL, by: [path]}]\n");
  EXPECT_THAT(refused(), HasSubstr("of c something else is expected"));
  small_.plan("runs: [{scenario: a.yaml}, {scenario: b.yaml}, {scenario: c.yaml}]\n");
  std::ofstream(small_.program(), std::ios::app) << "# another build\n";
  EXPECT_THAT(refused(), HasSubstr("begun by another build of kerfbench"));
  EXPECT_EQ(small_.calls(), calls);
}

TEST_F(BegunSuite, ADamagedRunIsSetAsideAndRunAgain) {
  ASSERT_EQ(runQuietly(small_.options()), 0);
  const fs::path run = small_.latest() / "runs/b";
  std::ofstream(run / "results/verdict.json") << "{}";
  EXPECT_EQ(runQuietly(resuming()), 0);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nc 1\nb 1\n");
  EXPECT_EQ(base::contentOf(run.string() + ".1/results/verdict.json"), "{}");
  EXPECT_EQ(small_.summary().at("runs")[1].at("earlier_tries"), 1);
}

TEST_F(BegunSuite, AMissingRunIsRunAgain) {
  ASSERT_EQ(runQuietly(small_.options()), 0);
  const std::string before = small_.summaryText();
  fs::remove_all(small_.latest() / "runs/b");
  fs::remove(small_.latest() / "summary.json");
  EXPECT_EQ(runQuietly(resuming()), 0);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nc 1\nb 1\n");
  EXPECT_EQ(small_.summaryText(), before);
}

TEST_F(BegunSuite, ARunWithoutAVerdictIsRunAgainAndOneWithIsNot) {
  small_.act("a", "verdict=FAIL");
  small_.act("b", "exit 2");
  ASSERT_EQ(runQuietly(small_.options()), 2);
  small_.act("b", "");
  EXPECT_EQ(runQuietly(resuming()), 1);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nc 1\nb 1\n");
  EXPECT_EQ(small_.outcomes(), "not as expected, as expected, as expected");
}

TEST_F(BegunSuite, ABrokenOrForeignRecordIsToldWithItsFolder) {
  EXPECT_THAT(refused(), AllOf(HasSubstr("latest"), HasSubstr("holds no suite")));
  ASSERT_EQ(runQuietly(small_.options()), 0);
  const fs::path record = small_.latest() / "suite.json";
  const std::string whole = base::contentOf(record);
  const auto with = [&](const std::string& text) {
    std::ofstream(record) << text;
    return refused();
  };
  EXPECT_THAT(with(whole.substr(0, 40)), HasSubstr("suite.json: is broken"));
  EXPECT_THAT(with("{\"schema_version\": 1}"), HasSubstr("lacks what a suite records"));
  EXPECT_THAT(with(base::replaced(whole, "\"schema_version\": 1", "\"schema_version\": 7")),
              HasSubstr("schema_version is 7, and this bench reads 1"));
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nc 1\n");
}

TEST_F(BegunSuite, ASecondWriterIsRefused) {
  ASSERT_EQ(runQuietly(small_.options()), 0);
  const batch::FolderLock other(small_.latest());
  EXPECT_THAT(refused(), HasSubstr("is being written by process"));
}

TEST_F(BegunSuite, AFullDiskLosesNothingThatHadEnded) {
  ASSERT_EQ(runQuietly(small_.options()), 0);
  const std::string uninterrupted = small_.summaryText();
  fs::remove_all(small_.latest() / "runs/b");
  const std::string before = base::contentOf(small_.latest() / "runs/a/job.json");
  // No file may become longer than a few bytes.
  rlimit unlimited{};
  ::getrlimit(RLIMIT_FSIZE, &unlimited);
  const sighandler_t handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit few{100, unlimited.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &few);
  const int code = runQuietly(resuming());
  ::setrlimit(RLIMIT_FSIZE, &unlimited);
  (void)::signal(SIGXFSZ, handler);
  EXPECT_EQ(code, 2);
  EXPECT_EQ(base::contentOf(small_.latest() / "runs/a/job.json"), before);
  EXPECT_EQ(small_.summaryText(), uninterrupted) << "the summary of before is whole";
  EXPECT_EQ(runQuietly(resuming()), 0);
  EXPECT_EQ(small_.outcomes(), "as expected, as expected, as expected");
}

}  // namespace
}  // namespace kerfbench::suite
