// SPDX-License-Identifier: Apache-2.0
// Pictures of the machine in results, as a user gets them: when they are there, and that nothing depends on
// them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

/// An environment variable with another value (or none) for the length of a scope.
class OtherVariable {
 public:
  OtherVariable(const char* name, const char* value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~OtherVariable() { set(before_ ? before_->c_str() : nullptr); }
  OtherVariable(const OtherVariable&) = delete;
  OtherVariable& operator=(const OtherVariable&) = delete;

 private:
  void set(const char* value) { value != nullptr ? ::setenv(name_, value, 1) : ::unsetenv(name_); }
  const char* name_;
  std::optional<std::string> before_;
};

/// Runs that end after a hundredth of a second, INVALID: pictures are made of these too.
class Pictures : public testing::Test {
 protected:
  Pictures() { fs::create_directory(temporary_); }

  ProgramRun run(const char* ci, const std::string& options) {
    const OtherVariable variable("CI", ci);
    const OtherVariable temporary("TMPDIR", temporary_.c_str());
    ProgramRun run = kerfbench(fmt::format("run '{}' --twin fast --time-limit 0.01 {} --results-dir '{}'",
                                           fixture("scenarios/short-lines.yaml").string(), options,
                                           scratch_.path().string()));
    EXPECT_EQ(run.exit_code, 3) << run.output;
    EXPECT_TRUE(fs::is_empty(temporary_)) << "something was left behind";
    return run;
  }
  [[nodiscard]] fs::path folder() const { return scratch_.path() / "short-lines" / "latest"; }
  [[nodiscard]] bool made() const {
    EXPECT_EQ(fs::exists(folder() / "machine.png"), fs::exists(folder() / "board.png"));
    const std::string page = textOf(folder() / "report.html");
    EXPECT_EQ(fs::exists(folder() / "machine.png"), page.find("The board in the end") != std::string::npos);
    return fs::exists(folder() / "machine.png");
  }

  ScratchFolder scratch_;
  const fs::path temporary_ = scratch_.path() / "temporary";
};

TEST_F(Pictures, AreMadeUnlessACiRunsTheBenchOrTheyAreRefused) {
  (void)run(nullptr, "-q");
  EXPECT_TRUE(made());
  const std::string digest = verdictOf(folder()).at("digest");
  const auto without = [&] { return !made() && verdictOf(folder()).at("digest") == digest; };
  (void)run(nullptr, "-q --no-pictures");
  EXPECT_TRUE(without());
  (void)run("true", "-q");
  EXPECT_TRUE(without());
  (void)run("true", "-q --pictures");
  EXPECT_TRUE(made());
  EXPECT_EQ(verdictOf(folder()).at("digest"), digest);
  (void)run("false", "-q");
  EXPECT_TRUE(made());
}

TEST_F(Pictures, NeedNoOtherProgram) {
  const OtherVariable path("PATH", "/nonexistent");
  (void)run(nullptr, "-q");
  EXPECT_TRUE(made());
}

TEST_F(Pictures, ComeAfterTheVerdict) {
  const ProgramRun told = run(nullptr, "--timing");
  const auto verdict = told.output.find("short-lines: INVALID");
  const auto report = told.output.find("report: ");
  ASSERT_NE(verdict, std::string::npos) << told.output;
  ASSERT_NE(report, std::string::npos) << told.output;
  EXPECT_LT(verdict, report);
  EXPECT_NE(told.output.find("s  pictures of the machine"), std::string::npos) << told.output;
}

TEST_F(Pictures, CannotBothBeAskedForAndRefused) {
  EXPECT_EQ(kerfbench("run x.yaml --pictures --no-pictures").exit_code, 64);
}

}  // namespace
}  // namespace kerfbench::test
