// SPDX-License-Identifier: Apache-2.0
#include "hil/base/one_processor.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

namespace kerfbench::base {
namespace {

cpu_set_t allowed(pid_t whom) {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(::sched_getaffinity(whom, sizeof set, &set), 0);
  return set;
}

bool same(const cpu_set_t& a, const cpu_set_t& b) { return CPU_EQUAL(&a, &b); }

/// A process that waits to be killed.
class Waiting {
 public:
  Waiting() : pid_(::fork()) {
    if (pid_ != 0) return;
    for (;;) ::pause();
  }
  ~Waiting() { end(); }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  void end() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  pid_t pid_;
};

TEST(OneProcessor, BothAreOnOneAfterTheFirstTurnsAndFreeAfterTheLast) {
  const Waiting other;
  ASSERT_GT(other.pid(), 0);
  const cpu_set_t before = allowed(0);
  {
    OneProcessor together(other.pid());
    together.turn();
    together.turn();
    const cpu_set_t mine = allowed(0);
    EXPECT_EQ(CPU_COUNT(&mine), 1);
    EXPECT_TRUE(same(mine, allowed(other.pid())));
  }
  EXPECT_TRUE(same(allowed(0), before));
  EXPECT_TRUE(same(allowed(other.pid()), before));
}

TEST(OneProcessor, AreLeftToTheSchedulerOnceInAWhile) {
  const Waiting other;
  const cpu_set_t before = allowed(0);
  if (CPU_COUNT(&before) < 2) GTEST_SKIP() << "this computer lets the test use one processor only";
  OneProcessor together(other.pid());
  int free = 0;
  for (int turn = 0; turn < 1000; ++turn) {
    together.turn();
    if (same(allowed(0), before) && same(allowed(other.pid()), before)) ++free;
  }
  EXPECT_GE(free, 5);
  EXPECT_LE(free, 20);
}

TEST(OneProcessor, OtherThreadsAreLeftAlone) {
  const Waiting other;
  const cpu_set_t before = allowed(0);
  std::thread([&] {
    OneProcessor together(other.pid());
    together.turn();
    together.turn();
  }).join();
  EXPECT_TRUE(same(allowed(0), before));
}

TEST(OneProcessor, WithoutAnotherProcessNothingHappens) {
  const cpu_set_t before = allowed(0);
  OneProcessor alone(0);
  for (int turn = 0; turn < 3; ++turn) alone.turn();
  EXPECT_TRUE(same(allowed(0), before));
}

TEST(OneProcessor, AProcessThatHasGoneIsNoError) {
  const cpu_set_t before = allowed(0);
  Waiting other;
  {
    OneProcessor together(other.pid());
    other.end();
    for (int turn = 0; turn < 300; ++turn) together.turn();
  }
  EXPECT_TRUE(same(allowed(0), before));
}

}  // namespace
}  // namespace kerfbench::base
