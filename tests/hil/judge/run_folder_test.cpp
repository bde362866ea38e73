// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/run_folder.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/judge/results_list.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::judge {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::UnorderedElementsAre;

const std::string kDigest = "1a2b3c4d5e6f7890";
const auto kEnd = std::chrono::sys_days{std::chrono::year{2026} / 11 / 28} + 16h + 5min + 12s;

void writeTo(const fs::path& path, const std::string& content) { std::ofstream(path) << content; }

fs::path keepRun(const fs::path& results, const std::string& content, std::chrono::seconds later = 0s) {
  RunFolder folder(results, "label");
  writeTo(folder.staging() / "verdict.json", content);
  folder.commit(kEnd + later, kDigest);
  return folder.place();
}

std::set<std::string> namesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

TEST(RunFolder, IsNamedByTimeAndDigest) {
  EXPECT_EQ(runFolderName(kEnd + 400ms, kDigest), "20261128T160512Z-1a2b3c4d");
  EXPECT_EQ(runFolderName(kEnd, ""), "20261128T160512Z-00000000");
  EXPECT_EQ(runFolderName(kEnd, "../../etc"), "20261128T160512Z-00000000");
  for (const char* good :
       {"20261128T160512Z-1a2b3c4d", "20261128T160512Z-1a2b3c4d-2", "20261128T160512Z-1a2b3c4d-17"})
    EXPECT_TRUE(isRunFolderName(good)) << good;
  for (const char* bad :
       {"", "latest", "20261128T160512Z", "20261128T160512Z-1a2b3c4", "20261128T160512Z-1a2b3c4g",
        "20261128T160512Z-1a2b3c4d-", "20261128T160512Z-1a2b3c4d-x", "2026-11-28T160512Z-1a2b3c4d"})
    EXPECT_FALSE(isRunFolderName(bad)) << bad;
}

TEST(RunFolder, NothingOfEarlierRunsIsReplaced) {
  const base::TempFolder temp;
  const fs::path first = keepRun(temp.path(), "first");
  const fs::path second = keepRun(temp.path(), "second", 1s);
  EXPECT_EQ(base::contentOf(first / "verdict.json"), "first");
  EXPECT_EQ(base::contentOf(temp.path() / "label" / kLatestRun / "verdict.json"), "second");
  EXPECT_EQ(fs::read_symlink(temp.path() / "label" / kLatestRun), second.filename());
  EXPECT_EQ(foreignIn(first), "");
  EXPECT_EQ(temp.entries(), 1);
}

// Two writers end in the same second with the same digest.
TEST(RunFolder, ATakenNameGetsANumber) {
  const base::TempFolder temp;
  const fs::path first = keepRun(temp.path(), "first"), second = keepRun(temp.path(), "second");
  EXPECT_EQ(second.filename(), first.filename().string() + "-2");
  EXPECT_EQ(base::contentOf(first / "verdict.json"), "first");
}

TEST(RunFolder, AnOutputIsTheResultsThemselves) {
  const base::TempFolder temp;
  const fs::path output = temp.path() / "one/run/";
  {
    RunFolder folder(temp.path() / "results", "label", output);
    writeTo(folder.staging() / "verdict.json", "{}");
    EXPECT_FALSE(fs::exists(output));
    folder.commit(kEnd, kDigest);
    EXPECT_EQ(folder.place(), temp.path() / "one/run");
  }
  EXPECT_THAT(namesIn(temp.path() / "one"), UnorderedElementsAre("run"));
  EXPECT_THAT(namesIn(output), UnorderedElementsAre("verdict.json", kResultsList));
  EXPECT_FALSE(fs::exists(temp.path() / "results"));
  // What is there is neither replaced nor added to.
  EXPECT_THROW(refuseBlockedRuns("results", "label", output), base::InputError);
  EXPECT_NO_THROW(refuseBlockedRuns("results", "label", temp.path() / "one/other"));
  RunFolder second("results", "label", output);
  EXPECT_THROW(second.commit(kEnd, kDigest), std::system_error);
  EXPECT_THAT(namesIn(output), UnorderedElementsAre("verdict.json", kResultsList));
}

TEST(RunFolder, WithoutACommitNothingIsLeft) {
  const base::TempFolder temp;
  {
    const RunFolder folder(temp.path(), "label");
    writeTo(folder.staging() / "half", "half");
  }
  EXPECT_EQ(temp.entries(), 0);
}

// Older benches put the results into the folder of the scenario itself.
TEST(RunFolder, ResultsOfAnOlderBenchBecomeARun) {
  const base::TempFolder temp;
  {
    ResultsFolder older(temp.path(), "label");
    writeTo(older.staging() / "verdict.json", R"({"digest": "00112233445566"})");
    older.commit();
  }
  const fs::path now = keepRun(temp.path(), "now");
  std::set<std::string> names = namesIn(temp.path() / "label");
  EXPECT_EQ(names.erase(kLatestRun), 1U);
  EXPECT_EQ(names.erase(now.filename().string()), 1U);
  ASSERT_EQ(names.size(), 1U);
  EXPECT_TRUE(isRunFolderName(*names.begin())) << *names.begin();
  EXPECT_THAT(*names.begin(), testing::HasSubstr("Z-00112233"));
  EXPECT_THAT(namesIn(temp.path() / "label" / *names.begin()),
              UnorderedElementsAre("verdict.json", kResultsList));
}

TEST(RunFolder, WhatIsInTheWayIsNamed) {
  const base::TempFolder temp;
  writeTo(temp.path() / "file", "");
  EXPECT_THROW(refuseBlockedRuns(temp.path(), "file"), base::InputError);
  fs::create_directories(temp.path() / "label" / kLatestRun);
  EXPECT_THROW(refuseBlockedRuns(temp.path(), "label"), base::InputError);
  EXPECT_NO_THROW(refuseBlockedRuns(temp.path(), "another"));
  (void)keepRun(temp.path() / "deep", "run");
  EXPECT_NO_THROW(refuseBlockedRuns(temp.path() / "deep", "label"));
}

// A place that somebody else took between two steps is not replaced either.
TEST(RunFolder, CommitNeverReplaces) {
  const base::TempFolder temp;
  ResultsFolder folder(temp.path(), "label");
  writeTo(folder.staging() / "mine", "mine");
  fs::create_directories(temp.path() / "taken");
  writeTo(temp.path() / "taken" / "theirs", "theirs");
  EXPECT_THROW(folder.commitTo(temp.path() / "taken"), std::system_error);
  EXPECT_EQ(base::contentOf(temp.path() / "taken" / "theirs"), "theirs");
}

}  // namespace
}  // namespace kerfbench::judge
