// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/run_jobs.h"

#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/batch/job_folder.h"
#include "tests/hil/batch/small_jobs.h"

namespace kerfbench::batch {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

std::vector<int> codesOf(const BatchEnd& end) {
  std::vector<int> codes;
  codes.reserve(end.jobs.size());
  for (const auto& outcome : end.jobs) codes.push_back(outcome ? outcome->end.code : -1);
  return codes;
}

class RunJobs : public testing::Test {
 protected:
  [[nodiscard]] BatchEnd run(const std::vector<Job>& jobs, const BatchOptions& options = {}) const {
    const FolderLock lock(small_.folder());
    return runJobs(lock, jobs, options);
  }
  SmallJobs small_;
};

TEST_F(RunJobs, ResultsAreInTheOrderOfTheJobs) {
  const NamedPipe second_done(small_.folder() / "pipe");
  // The first ends after the second, which has to run beside it.
  const std::vector<Job> jobs{small_.job("a", "read line < " + second_done.path() + "; exit 1"),
                              small_.job("b", "echo out; echo err >&2; echo result > $0/r; echo > " +
                                                  second_done.path() + "; exit 4"),
                              small_.job("c", "exit 0")};
  std::vector<std::size_t> told;
  const BatchEnd end = run(jobs, {.at_once = 2, .ended = [&](std::size_t job, const JobOutcome& outcome) {
                                    told.push_back(job);
                                    EXPECT_FALSE(outcome.kept);
                                    return true;
                                  }});
  EXPECT_THAT(codesOf(end), ElementsAre(1, 4, 0));
  EXPECT_FALSE(end.signal.has_value());
  EXPECT_THAT(told, UnorderedElementsAre(0U, 1U, 2U));
  EXPECT_EQ(base::contentOf(jobs[1].folder / kJobLog), "out\nerr\n");
  EXPECT_EQ(base::contentOf(jobs[1].folder / "r"), "result\n");
  for (const Job& job : jobs) EXPECT_EQ(lookAt(job).state, JobFolder::State::kWhole);
}

TEST_F(RunJobs, NoMoreRunAtOnceThanAllowedAndOneThatIsAloneRunsAlone) {
  std::vector<Job> jobs;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) jobs.push_back(small_.job(name, "exit 0"));
  jobs[3].alone = true;
  std::size_t most = 0;
  bool alone_ran = false;
  (void)run(jobs, {.at_once = 3, .waiting = [&](const std::vector<std::size_t>& running) {
                     most = std::max(most, running.size());
                     if (std::ranges::find(running, 3U) == running.end()) return;
                     alone_ran = true;
                     EXPECT_THAT(running, ElementsAre(3U));
                   }});
  EXPECT_EQ(most, 3U);
  EXPECT_TRUE(alone_ran);
}

TEST_F(RunJobs, ACrashAndAMissingProgramAreResultsOfTheirJobAlone) {
  std::vector<Job> jobs{small_.job("a", "kill -SEGV $$"), small_.job("b", ""), small_.job("c", "exit 3")};
  jobs[1].command = {(small_.folder() / "no-such-program").string()};
  const BatchEnd end = run(jobs);
  EXPECT_EQ(end.jobs[0]->end.how, JobEnd::How::kSignal);
  EXPECT_EQ(describe(end.jobs[0]->end), "was ended by signal 11 (Segmentation fault)");
  EXPECT_EQ(end.jobs[1]->end.how, JobEnd::How::kNotStarted);
  EXPECT_EQ(describe(end.jobs[1]->end), "could not be started: No such file or directory");
  EXPECT_EQ(describe(end.jobs[2]->end), "ended with exit code 3");
}

TEST_F(RunJobs, WhatAJobLeavesRunningEndsWithIt) {
  NamedPipe held(small_.folder() / "pipe");
  held.onlyReads();
  const NamedPipe never(small_.folder() / "never");
  (void)run({small_.job("a", "exec 3> " + held.path() + "; read never < " + never.path() + " & exit 0")});
  EXPECT_TRUE(held.ends());
}

TEST_F(RunJobs, AJobHasNoInputAndNoBlockedSignals) {
  const StopSignals signals;
  (void)run({small_.job("a", "read line; echo \"$? $(grep SigBlk /proc/self/status)\"")});
  EXPECT_EQ(base::contentOf(small_.folder() / "runs/a/log.txt"), "1 SigBlk:\t0000000000000000\n");
}

TEST_F(RunJobs, WholeResultsAreKept) {
  const std::vector<Job> jobs{small_.job("a", "echo a >> $1"), small_.job("b", "echo b >> $1; exit 2")};
  (void)run(jobs);
  std::vector<std::size_t> kept;
  const BatchEnd again = run(jobs, {.ended = [&](std::size_t job, const JobOutcome& outcome) {
                               if (outcome.kept) kept.push_back(job);
                               return true;
                             }});
  EXPECT_EQ(small_.noted(), "a\nb\n");
  EXPECT_THAT(kept, ElementsAre(0U, 1U));
  EXPECT_THAT(codesOf(again), ElementsAre(0, 2));
}

TEST_F(RunJobs, WhatIsOfNoUseIsRunAgainAndTheOldIsKeptBeside) {
  const std::vector<Job> jobs{small_.job("a", "echo a >> $1"), small_.job("b", "echo b >> $1; exit 2")};
  (void)run(jobs);
  const BatchEnd again = run(jobs, {.runs_again = [](const JobEnd& end) { return end.exitedWith(2); }});
  EXPECT_EQ(small_.noted(), "a\nb\nb\n");
  EXPECT_EQ(again.jobs[0]->earlier_tries, 0);
  EXPECT_EQ(again.jobs[1]->earlier_tries, 1);
  EXPECT_TRUE(fs::exists(jobs[1].folder.string() + ".1/" + kJobRecord));
}

TEST_F(RunJobs, ADamagedResultIsSetAsideAndRunAgain) {
  const std::vector<Job> jobs{small_.job("a", "echo a >> $1; echo r > $0/r")};
  (void)run(jobs);
  std::ofstream(jobs[0].folder / "r") << "x";
  std::vector<std::string> remarks;
  const BatchEnd again = run(jobs, {.remark = [&](const std::string& remark) { remarks.push_back(remark); }});
  EXPECT_EQ(small_.noted(), "a\na\n");
  EXPECT_THAT(remarks, ElementsAre(HasSubstr("'r' was changed; it is kept as")));
  EXPECT_EQ(base::contentOf(jobs[0].folder.string() + ".1/r"), "x");
  EXPECT_EQ(base::contentOf(jobs[0].folder / "r"), "r\n");
  EXPECT_EQ(again.jobs[0]->earlier_tries, 1);
}

TEST_F(RunJobs, OtherInputsAndForeignFoldersAreAllRefusedBeforeAnythingRuns) {
  std::vector<Job> jobs{small_.job("a", "echo a >> $1"), small_.job("b", "echo b >> $1"),
                        small_.job("c", "echo c >> $1")};
  (void)run({jobs[0]});
  jobs[0].inputs += ", changed";
  fs::create_directories(jobs[1].folder);
  std::ofstream(jobs[1].folder / "thesis.txt") << "mine";
  try {
    (void)run(jobs);
    FAIL() << "not refused";
  } catch (const base::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("runs/a: is the result of other inputs\n"));
    EXPECT_THAT(e.what(), HasSubstr("runs/b: holds what no run wrote"));
  }
  EXPECT_EQ(small_.noted(), "a\n");
  EXPECT_EQ(base::contentOf(jobs[1].folder / "thesis.txt"), "mine");
}

TEST_F(RunJobs, NothingIsStartedAfterAJobThatEndsIt) {
  const std::vector<Job> jobs{small_.job("a", "exit 0"), small_.job("b", "exit 1"),
                              small_.job("c", "exit 0")};
  const BatchEnd end =
      run(jobs, {.ended = [](std::size_t, const JobOutcome& outcome) { return outcome.end.exitedWith(0); }});
  EXPECT_THAT(codesOf(end), ElementsAre(0, 1, -1));
  EXPECT_FALSE(fs::exists(jobs[2].folder));
  EXPECT_THAT(codesOf(run(jobs)), ElementsAre(0, 1, 0));
}

TEST_F(RunJobs, FoldersMustBeInTheLocksAndDifferent) {
  Job elsewhere = small_.job("a", "exit 0");
  elsewhere.folder = small_.folder() / "../elsewhere";
  EXPECT_THROW((void)run({elsewhere}), std::invalid_argument);
  EXPECT_THROW((void)run({small_.job("a", ""), small_.job("a", "")}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::batch
