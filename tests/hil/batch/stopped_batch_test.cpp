// SPDX-License-Identifier: Apache-2.0
// Batches that end before their jobs have: by a signal, by kill -9, by a full disk.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/batch/job_folder.h"
#include "hil/batch/run_jobs.h"
#include "tests/hil/batch/small_jobs.h"

namespace kerfbench::batch {
namespace {

namespace fs = std::filesystem;

class StoppedBatch : public testing::Test {
 protected:
  [[nodiscard]] BatchEnd run(const std::vector<Job>& jobs, const BatchOptions& options = {}) const {
    const FolderLock lock(small_.folder());
    return runJobs(lock, jobs, options);
  }
  SmallJobs small_;
};

TEST_F(StoppedBatch, ASignalIsPassedOnAndTheRestRunsLater) {
  const NamedPipe begun(small_.folder() / "pipe");
  const std::string lasts = "echo b >> $1; echo > " + begun.path() + "; read never < " + begun.path() + ".no";
  const NamedPipe never(begun.path() + ".no");
  std::vector<Job> jobs{small_.job("a", "echo a >> $1"), small_.job("b", lasts),
                        small_.job("c", "echo c >> $1")};
  StopSignals signals;
  bool raised = false;
  const BatchEnd end =
      run(jobs, {.signals = &signals, .waiting = [&](const std::vector<std::size_t>& running) {
                   if (raised || running.front() != 1) return;
                   (void)begun.line();
                   raised = ::raise(SIGTERM) == 0;
                 }});
  EXPECT_EQ(end.signal, SIGTERM);
  EXPECT_TRUE(end.jobs[0]->end.exitedWith(0));
  EXPECT_FALSE(end.jobs[1].has_value());
  EXPECT_FALSE(end.jobs[2].has_value());
  EXPECT_EQ(lookAt(jobs[1]).state, JobFolder::State::kAbsent);
  EXPECT_EQ(small_.noted(), "a\nb\n");
  jobs[1] = small_.job("b", "echo b >> $1");
  EXPECT_TRUE(run(jobs).jobs[2]->end.exitedWith(0));
  EXPECT_EQ(small_.noted(), "a\nb\nb\nc\n");
}

/// A job that ignores SIGTERM.
class DeafJob : public StoppedBatch {
 protected:
  /// Runs it, and sends SIGTERM to this process so many times once the job ignores it.
  [[nodiscard]] BatchEnd runAndRaise(int times, double grace_s) {
    int raised = 0;
    return run({small_.job("a", "trap '' TERM; echo > " + begun_.path() + "; read never < " + never_.path())},
               {.signals = &signals_, .grace_s = grace_s, .waiting = [&](const std::vector<std::size_t>&) {
                  if (raised == 0) (void)begun_.line();
                  if (raised < times) EXPECT_EQ(::raise(SIGTERM), 0);
                  ++raised;
                }});
  }
  const NamedPipe begun_{small_.folder() / "pipe"};
  const NamedPipe never_{small_.folder() / "never"};
  StopSignals signals_;
};

TEST_F(DeafJob, IsKilledByASecondSignal) {
  constexpr double kForEver_s = 1e6;
  const BatchEnd end = runAndRaise(2, kForEver_s);
  EXPECT_EQ(end.signal, SIGTERM);
  EXPECT_FALSE(end.jobs[0].has_value());
}

TEST_F(DeafJob, IsKilledWhenItsGraceIsOver) {
  const BatchEnd end = runAndRaise(1, 0.0);
  EXPECT_EQ(end.signal, SIGTERM);
  EXPECT_FALSE(end.jobs[0].has_value());
}

TEST_F(StoppedBatch, AfterAKillNothingRunsOnAndTheRestRunsLater) {
  NamedPipe begun(small_.folder() / "pipe");
  const NamedPipe never(small_.folder() / "never");
  std::vector<Job> jobs{
      small_.job("a", "echo a >> $1; echo r > $0/r"),
      small_.job("b", "echo b >> $1; exec 3> " + begun.path() + "; echo >&3; read never < " + never.path())};
  const pid_t bench = ::fork();
  if (bench == 0) {
    (void)run(jobs);
    ::_exit(0);
  }
  (void)begun.line();
  begun.onlyReads();
  ASSERT_EQ(::kill(bench, SIGKILL), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(bench, &status, 0), bench);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(begun.ends());  // The job, which held the pipe, has been killed as well.
  EXPECT_EQ(lookAt(jobs[0]).state, JobFolder::State::kWhole);
  EXPECT_EQ(lookAt(jobs[1]).state, JobFolder::State::kUnfinished);
  jobs[1] = small_.job("b", "echo b >> $1");
  const BatchEnd end = run(jobs);
  EXPECT_TRUE(end.jobs[0]->kept);
  EXPECT_FALSE(end.jobs[1]->kept);
  EXPECT_EQ(small_.noted(), "a\nb\nb\n");
  EXPECT_FALSE(fs::exists(jobs[1].folder.string() + ".1"));
}

TEST(StopSignals, WhatTheProcessIgnoresStaysIgnored) {
  const sighandler_t before = ::signal(SIGHUP, SIG_IGN);
  {
    StopSignals signals;
    ASSERT_EQ(::raise(SIGHUP), 0);
    EXPECT_FALSE(signals.take().has_value());
    ASSERT_EQ(::raise(SIGTERM), 0);
    EXPECT_EQ(signals.take(), SIGTERM);
    EXPECT_FALSE(signals.take().has_value());
  }
  (void)::signal(SIGHUP, before);
}

/// No file may become longer than a few bytes, as on a disk that is full.
class FullDisk {
 public:
  FullDisk() {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = ::signal(SIGXFSZ, SIG_IGN);
    const rlimit few{64, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &few);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    (void)::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  sighandler_t handler_{};
};

TEST_F(StoppedBatch, AFullDiskEndsItAndWhatWasRecordedStays) {
  const std::vector<Job> jobs{small_.job("a", "echo a >> $1"), small_.job("b", "echo b >> $1")};
  std::optional<FullDisk> full;
  EXPECT_THROW((void)run(jobs, {.ended =
                                    [&](std::size_t, const JobOutcome&) {
                                      full.emplace();
                                      return true;
                                    }}),
               std::system_error);
  full.reset();
  EXPECT_EQ(lookAt(jobs[0]).state, JobFolder::State::kWhole);
  EXPECT_EQ(lookAt(jobs[1]).state, JobFolder::State::kUnfinished);
  const BatchEnd end = run(jobs);
  EXPECT_TRUE(end.jobs[0]->kept);
  EXPECT_TRUE(end.jobs[1]->end.exitedWith(0));
}

}  // namespace
}  // namespace kerfbench::batch
