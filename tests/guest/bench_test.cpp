// SPDX-License-Identifier: Apache-2.0
// The product's own measurement of its edge rate and of the accuracy of its stamps, on a loop-back of two
// lines of the kernel's simulated chip. Its figures are those of the guest's time: instructions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/guest/held_line.h"
#include "tests/guest/sim_chip.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint32_t kOut = 0;
constexpr std::uint32_t kIn = 1;

class BenchTest : public testing::Test {
 protected:
  ~BenchTest() override {
    ::unsetenv("LD_PRELOAD");
    ::unsetenv("KERFBENCH_JUMPER");
  }
  /// Connects OUT to this line, for programs that are started from now on.
  void plugJumper(std::uint32_t to) {
    ::setenv("KERFBENCH_JUMPER", chip.pullFile(to).c_str(), 1);
    ::setenv("LD_PRELOAD", KERFBENCH_GUEST_JUMPER, 1);
  }
  test::ProgramRun bench(const std::string& more) const {
    return test::kerfbench(fmt::format("doctor --bench --chip {} --loop-back OUT=IN {}", chip.label(), more));
  }
  SimChip chip{"kerfbench-loop", {"OUT", "IN", "SPARE", ""}};
};

TEST_F(BenchTest, TenThousandEdgesASecondAndMoreAreReadWithoutLossAndItIsSaidWhere) {
  plugJumper(kIn);
  const test::ProgramRun done = bench("--seconds 0.5");
  fmt::print("{}\n", done.output);
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.output, AllOf(HasSubstr("MEASURED IN A VIRTUAL MACHINE"), HasSubstr("stamp_err_us: "),
                                 HasSubstr("| 10000 | 10000 | 5000 | 5000 |")));
}

TEST_F(BenchTest, TheFiguresForMachinesSayTheSame) {
  plugJumper(kIn);
  const test::ProgramRun done = bench("--rates 10000,1000 --seconds 0.2 --json");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const auto json = nlohmann::json::parse(done.output);
  EXPECT_NE(json["virtual_machine"], "");
  EXPECT_EQ(json["real_time"], true);
  ASSERT_EQ(json["rates"].size(), 2U);
  for (const auto& rate : json["rates"]) {
    EXPECT_EQ(rate["driven"], rate["read"]);
    EXPECT_EQ(rate["problems"].size(), 0U);
    EXPECT_LE(rate["stamp_late"]["at_least"]["worst_us"], rate["stamp_late"]["at_most"]["worst_us"]);
    EXPECT_LE(rate["stamp_late"]["at_most"]["worst_us"], json["stamp_err_us"]);
    EXPECT_GT(rate["reader_share"], 0.0);
    EXPECT_LT(rate["reader_share"], 1.0);
  }
  EXPECT_GE(json["sustained_hz"], 9'500.0);
}

TEST_F(BenchTest, AJumperThatIsMissingOrElsewhereIsSaid) {
  test::ProgramRun done = bench("");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.output, HasSubstr("line 1 (IN) stays low whatever line 0 (OUT)"));
  plugJumper(kIn + 1);
  done = bench("");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.output, HasSubstr("the jumper is missing, or on other lines"));
}

TEST_F(BenchTest, ALineThatAnotherProgramHasIsNamedWithItsUser) {
  plugJumper(kIn);
  const HeldLine held(chip.device(), kOut, "spi0 CS1");
  const test::ProgramRun done = bench("");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.output, HasSubstr("line 0 for OUT is taken by 'spi0 CS1'"));
}

}  // namespace
}  // namespace kerfbench::guest
