// SPDX-License-Identifier: Apache-2.0
// Faults name a parameter as its user does: by an option of kerfplan, or by a key of a scenario or machine
// file.
#include "firmware_under_test/planner/job/parameter_names.h"

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/program/job_issues.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::string page(const std::string& name) {
  std::ifstream file(std::string(KERFBENCH_SOURCE_DIR) + "/docs/reference/" + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Pages that other tests hold against the programs have each option and key.
TEST(ParameterNames, AreOptionsAndKeysThatExist) {
  const std::string options = page("cli.md");
  const std::string keys = page("scenario.md") + page("machine.md");
  ASSERT_FALSE(options.empty());
  std::set<Parameter> seen;
  for (const ParameterName& name : parameterNames()) {
    EXPECT_TRUE(seen.insert(name.parameter).second);
    EXPECT_TRUE(name.option != nullptr || name.key != nullptr);
    std::istringstream options_of(name.option == nullptr ? "" : name.option);
    for (std::string option; options_of >> option;)
      EXPECT_THAT(options, HasSubstr("`" + option.substr(0, option.find(',')) + "`"));
    if (name.key == nullptr) continue;
    const std::string key = name.key;
    EXPECT_THAT(keys, HasSubstr(key.substr(key.rfind('.') + 1) + "`")) << key;
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(Parameter::kSpotDiameter) + 1);
}

TEST(ParameterNames, AreThoseOfWhoeverGaveTheJob) {
  JobParameters job = test::mirrorJob();
  job.stop_and_go = true;
  job.belt_speed_mm_s = 20.0;
  MachineParameters machine = test::twoMirror();
  machine.throw_mm = -1.0;
  machine.mirror_step_rad = 0.2;
  machine.tracking_delay_s = 2.5;
  job.given_by = GivenBy::kCommandLine;
  std::vector<std::string> faults = jobIssues(machine, job);
  EXPECT_THAT(faults, Contains("--stop-and-go needs --feed"));
  EXPECT_THAT(faults, Contains("--throw must be > 0, but is -1"));
  EXPECT_THAT(faults, Contains("--mirror-step must be at most 0.1, but is 0.2"));
  EXPECT_THAT(faults, Contains(HasSubstr("--tracking-delay must be in 0 … ")));
  EXPECT_THAT(faults, Contains(HasSubstr("but is 2.5")));
  job.given_by = GivenBy::kScenario;
  faults = jobIssues(machine, job);
  EXPECT_THAT(faults, Contains("planner.stop_and_go needs belt.drive: controller"));
  EXPECT_THAT(faults, Contains("controller.throw_mm must be > 0, but is -1"));
  // A machine file has microradians and milliseconds.
  EXPECT_THAT(faults, Contains("controller.mirror_step_urad must be at most 100000, but is 200000"));
  EXPECT_THAT(faults, Contains(HasSubstr("controller.tracking_delay_ms must be in 0 … ")));
  EXPECT_THAT(faults, Contains(HasSubstr("but is 2500")));
}

}  // namespace
}  // namespace kerfbench::planner
