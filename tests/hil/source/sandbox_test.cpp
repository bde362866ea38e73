// SPDX-License-Identifier: Apache-2.0
// What a firmware that has taken over its emulator can do.
#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>

#include "hil/source/open.h"

namespace kerfbench::source {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

ChildSourceOptions childThat(const std::string& what) {
  ChildSourceOptions options;
  options.child = KERFBENCH_ESCAPING_CHILD;
  options.image = std::filesystem::path(::testing::TempDir()) / "taken-over";
  if (std::FILE* file = std::fopen(options.image.c_str(), "w")) std::fclose(file);
  options.mcu = what;
  return options;
}

#ifdef KERFBENCH_SANITIZED
constexpr bool kConfined = false;
#else
constexpr bool kConfined = true;
#endif

class Escape : public ::testing::TestWithParam<const char*> {};

TEST_P(Escape, EndsTheEmulatorAndNothingElse) {
  if (!kConfined) GTEST_SKIP() << "the sanitizers need system calls of their own";
  const auto source = openChild(childThat(GetParam()));
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kCrashed);
  EXPECT_THAT(source->message(), HasSubstr("Bad system call"));
  EXPECT_TRUE(batch.events.empty());
}

INSTANTIATE_TEST_SUITE_P(Attempts, Escape,
                         ::testing::Values("opens a file", "makes a file", "removes a file", "opens a socket",
                                           "forks", "opens a file anew", "runs a program", "makes code",
                                           "makes memory code", "maps a file", "kills the bench",
                                           "looks into the bench", "reads the bench"));

class Honest : public ::testing::TestWithParam<const char*> {};

TEST_P(Honest, WorkGoesOn) {
  const auto source = openChild(childThat(GetParam()));
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kReached) << source->message();
  EXPECT_EQ(source->advance(200, batch), Stop::kReached) << source->message();
}

INSTANTIATE_TEST_SUITE_P(Works, Honest, ::testing::Values("computes", "prints", "takes memory", "throws"));

TEST(Emulator, ThatAbortsIsSaidToHaveAborted) {
  const auto source = openChild(childThat("aborts"));
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kCrashed);
  EXPECT_THAT(source->message(), HasSubstr("Aborted"));
}

TEST(Emulator, ThatTakesTooMuchMemoryEndsAlone) {
  if (!kConfined) GTEST_SKIP() << "the sanitizers take terabytes of addresses";
  const auto source = openChild(childThat("takes too much memory"));
  Batch batch;
  EXPECT_EQ(source->advance(100, batch), Stop::kCrashed);
  EXPECT_THAT(source->message(), AnyOf(HasSubstr("bad_alloc"), HasSubstr("Aborted")));
}

}  // namespace
}  // namespace kerfbench::source
