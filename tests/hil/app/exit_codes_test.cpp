// SPDX-License-Identifier: Apache-2.0
#include "hil/app/exit_codes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "hil/app/commands.h"
#include "hil/app/results_folder.h"
#include "hil/base/yaml_reader.h"
#include "tests/hil/app/temp_folder.h"
#include "twin/machine/divergence.h"

namespace kerfbench::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ExitCodes, AModelThatDivergesBreaksTheBenchAndIsNoVerdict) {
  const TempFolder temp;
  testing::internal::CaptureStderr();
  const int code = guarded("job.yaml", [&]() -> int {
    const ResultsFolder folder(temp.path(), "job");
    throw twin::DivergenceError(1.25, "gantry_x.bridge");
  });
  EXPECT_EQ(code, kExitBroken);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("job.yaml: "), HasSubstr("1.25"), HasSubstr("gantry_x.bridge"),
                    HasSubstr("no verdict")));
  EXPECT_EQ(temp.entries(), 0);  // Nothing half-written.
}

TEST(ExitCodes, BadInputIsToldInTheUsersWords) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(guarded("job.yaml", []() -> int { throw ConfigError("m.yaml:3: wrong"); }), kExitInput);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "m.yaml:3: wrong\n");
  EXPECT_EQ(guarded("job.yaml", [] { return 4; }), 4);
  EXPECT_THROW(guarded("job.yaml", []() -> int { throw std::logic_error("a bug"); }), std::logic_error);
}

TEST(ExitCodes, TheGravestOfSeveralCounts) {
  EXPECT_EQ(gravest(0, 4), 4);
  EXPECT_EQ(gravest(1, 4), 1);
  EXPECT_EQ(gravest(3, 1), 3);
  EXPECT_EQ(gravest(kExitInput, 3), kExitInput);
  EXPECT_EQ(gravest(kExitInput, kExitBroken), kExitBroken);
}

}  // namespace
}  // namespace kerfbench::hil
