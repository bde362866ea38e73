// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdio>
#include <ostream>

#include "hil/source/open.h"

namespace kerfbench::source {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

ChildSourceOptions misbehaving(const std::string& how) {
  const auto image = std::filesystem::path(::testing::TempDir()) / how;
  if (std::FILE* file = std::fopen(image.c_str(), "w")) std::fclose(file);
  ChildSourceOptions options;
  options.child = KERFBENCH_MISBEHAVING_CHILD;
  options.image = image;
  options.hang_guard_s = 0.5;
  return options;
}

void expectNoChildrenLeft() {
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

struct Case {
  const char* how;
  Stop stop;
  const char* words;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.how; }

class Misbehaving : public ::testing::TestWithParam<Case> {};

TEST_P(Misbehaving, ChildIsStoppedWithTheReasonAndWithoutEvidence) {
  {
    const auto source = openChild(misbehaving(GetParam().how));
    Batch batch;
    EXPECT_EQ(source->advance(100, batch), GetParam().stop);
    EXPECT_THAT(source->message(), HasSubstr(GetParam().words));
    EXPECT_TRUE(batch.events.empty());
    EXPECT_EQ(batch.watermark, 0U);
    EXPECT_EQ(source->advance(200, batch), GetParam().stop);
  }
  expectNoChildrenLeft();
}

INSTANTIATE_TEST_SUITE_P(
    Protocol, Misbehaving,
    ::testing::Values(Case{"dies-by-signal", Stop::kCrashed, "first words | last words"},
                      Case{"dies-by-signal", Stop::kCrashed, "signal Segmentation fault"},
                      Case{"hangs", Stop::kHung, "wall-clock guard"},
                      Case{"huge-length", Stop::kCrashed, "too long"},
                      Case{"cut-off", Stop::kCrashed, "exit status 3"},
                      Case{"unknown-reply", Stop::kCrashed, "unknown reply 99"},
                      Case{"unknown-stop", Stop::kCrashed, "stop code 77"},
                      Case{"wrong-watermark", Stop::kCrashed, "watermark 50"},
                      Case{"late-watermark", Stop::kCrashed, "watermark 101"},
                      Case{"too-many", Stop::kCrashed, "more events"},
                      Case{"fewer-than-said", Stop::kCrashed, "too short"},
                      Case{"descending", Stop::kCrashed, "ascend"}, Case{"beyond", Stop::kCrashed, "ascend"},
                      Case{"contradiction", Stop::kCrashed, "contradict"},
                      Case{"back-at-once", Stop::kCrashed, "a pin changes twice at tick 8"},
                      Case{"uart-flood", Stop::kFlooded, "more than 1.25 MB a second"},
                      Case{"leaves-children", Stop::kHung, "did not answer"},
                      Case{"left-over", Stop::kCrashed, "left over"}));

std::string openingFault(const ChildSourceOptions& options) {
  try {
    (void)openChild(options);
  } catch (const std::runtime_error& fault) {
    return fault.what();
  }
  return "opened";
}

TEST(ChildSource, OpeningFaultsAreToldInWords) {
  EXPECT_THAT(openingFault(misbehaving("dies-at-once")), HasSubstr("exit status 7"));
  EXPECT_THAT(openingFault(misbehaving("wrong-version")), HasSubstr("version 99"));
  EXPECT_THAT(openingFault(misbehaving("silent")), HasSubstr("no answer"));
  expectNoChildrenLeft();
}

TEST(ChildSource, MissingProgramIsASystemError) {
  auto options = misbehaving("hangs");
  options.child = "/nonexistent/kerfbench-avr";
  EXPECT_THROW((void)openChild(options), std::system_error);
  expectNoChildrenLeft();
}

TEST(ChildSource, ATalkativeChildNeitherBlocksNorOutlivesItsSource) {
  {
    const auto source = openChild(misbehaving("talkative"));
    Batch batch;
    EXPECT_EQ(source->advance(100, batch), Stop::kReached) << source->message();
  }
  expectNoChildrenLeft();
}

TEST(ChildSource, WhatAChildHasStartedEndsWithIt) {
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  const auto source = openChild(misbehaving("leaves-children"));
  const pid_t group = source->info().process;
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kHung);  // The pipe of its replies is still open.
  int status = 0;
  ASSERT_GT(::waitpid(-group, &status, 0), 0);  // An orphan is the subreaper's.
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
  (void)::prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST(ChildSource, PatienceInAllEndsAsWell) {
  auto options = misbehaving("hangs");
  options.hang_guard_s = 1e6;
  options.patience_s = 0.2;
  const auto source = openChild(options);
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kHung);
}

std::string seenBy(const ChildSourceOptions& options, std::string* unconfined) {
  const auto source = openChild(options);
  *unconfined = source->info().unconfined;
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kCrashed);
  return source->message();
}

TEST(ChildSource, AForeignChildSeesNothingOfTheComputer) {
  auto options = misbehaving("looks-around");
  options.hang_guard_s = 20;
  std::string unconfined;
  const std::string open = seenBy(options, &unconfined);
  EXPECT_EQ(unconfined, "");  // Nobody has asked.
  EXPECT_THAT(open,
              AllOf(HasSubstr("reads accounts"), HasSubstr("has an environment"), HasSubstr("writes files"),
                    HasSubstr("sees processes"), HasSubstr("reaches the bench")));
  options.confined = true;
  const std::string confined = seenBy(options, &unconfined);
  if (!unconfined.empty()) GTEST_SKIP() << unconfined;
  EXPECT_THAT(confined, HasSubstr("it said: has looked"));
}

TEST(ChildSource, UartForAHungChildDoesNotBlockTheBench) {
  const auto source = openChild(misbehaving("hangs"));
  Batch batch;
  source->uartWrite(std::vector<std::uint8_t>(8U << 20U, 'x'));
  EXPECT_EQ(source->advance(100, batch), Stop::kHung);
}

}  // namespace
}  // namespace kerfbench::source
