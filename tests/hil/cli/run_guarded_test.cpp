// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/run_guarded.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "hil/base/atomic_file.h"
#include "hil/base/exit_codes.h"
#include "hil/base/yaml_reader.h"
#include "hil/cli/program.h"
#include "hil/judge/results_folder.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/machine/divergence.h"

namespace kerfbench::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(ExitCodes, AModelThatDivergesBreaksTheBenchAndIsNoVerdict) {
  const base::TempFolder temp;
  testing::internal::CaptureStderr();
  const int code = runGuarded("job.yaml", [&]() -> int {
    const judge::ResultsFolder folder(temp.path(), "job");
    throw twin::DivergenceError(1.25, "gantry_x.bridge");
  });
  EXPECT_EQ(code, base::kExitBroken);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("job.yaml: "), HasSubstr("1.25"), HasSubstr("gantry_x.bridge"),
                    HasSubstr("no verdict")));
  EXPECT_EQ(temp.entries(), 0);  // No file is left half-written.
}

TEST(ExitCodes, BadInputIsToldInTheUsersWords) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(runGuarded("job.yaml", []() -> int { throw base::ConfigError("m.yaml:3: wrong"); }),
            base::kExitInput);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "m.yaml:3: wrong\n");
  EXPECT_EQ(runGuarded("job.yaml", [] { return 4; }), 4);
  EXPECT_THROW(runGuarded("job.yaml", []() -> int { throw std::logic_error("a bug"); }), std::logic_error);
}

TEST(ExitCodes, AFolderThatIsMissingIsTheUsersToMend) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(guardedMain([]() -> int {
              base::writeFileAtomically("/nowhere/a.png", "x");
              return 0;
            }),
            base::kExitInput);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("its folder /nowhere cannot be used"), Not(HasSubstr("itself broke"))));
}

TEST(ExitCodes, TheGravestOfSeveralCounts) {
  EXPECT_EQ(base::worstExitCode(0, 4), 4);
  EXPECT_EQ(base::worstExitCode(1, 4), 1);
  EXPECT_EQ(base::worstExitCode(3, 1), 3);
  EXPECT_EQ(base::worstExitCode(base::kExitInput, 3), base::kExitInput);
  EXPECT_EQ(base::worstExitCode(base::kExitInput, base::kExitBroken), base::kExitBroken);
}

}  // namespace
}  // namespace kerfbench::cli
