// SPDX-License-Identifier: Apache-2.0
#include "hil/app/case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"
#include "tests/hil/app/temp_folder.h"

namespace kerfbench::hil {
namespace {

using testing::HasSubstr;

class CaseTest : public testing::Test {
 protected:
  void SetUp() override { (void)temp_.write("controller-avr.hex", ":00000001FF\n"); }
  Case label(const std::string& lines) const {
    const auto path = temp_.write("s.yaml", "extends: " + fixture("scenarios/label-on-belt.yaml").string() +
                                                "\nname: changed\n" + lines);
    return readCase(path, temp_.path());
  }
  std::string faultsOf(const std::string& lines) const {
    try {
      label(lines);
    } catch (const ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const TempFolder temp_;
};

TEST_F(CaseTest, TheFirstEyeMarkReachesItsSensorAfterTheLeadTime) {
  const Case the_case = label("belt: {lead_s: 0.7}\n");
  const twin::WebDescription web = webOf(the_case);
  const double mark_mm = web.start_x_mm + web.print.eye_mark_x_mm + 0.7 * web.belt_speed_mm_s;
  EXPECT_NEAR(mark_mm, the_case.machine.belt.print_mark_sensor_x_mm, 1e-9);
  EXPECT_EQ(plannerJob(the_case).web_start_x_mm, web.start_x_mm);
}

TEST_F(CaseTest, ThePlannerIsToldTheDataSheetAndNotTheTruth) {
  Case the_case = label("");
  the_case.machine.throw_mm = 512.0;
  the_case.machine.belt.encoder_count_mm = 0.02;
  EXPECT_EQ(plannerMachine(the_case).throw_mm, 500.0);
  EXPECT_EQ(plannerMachine(the_case).encoder_count_mm, 0.01);
}

TEST_F(CaseTest, AMachineWithoutAFeedDriveCannotFeed) {
  const std::string machine = contentOf(fixture("machines/two-mirror.yaml"));
  std::string without =
      replaced(machine, "drivers: drivers.yaml", "drivers: " + fixture("machines/drivers.yaml").string());
  const auto feed = without.find("  feed: {");
  ASSERT_NE(feed, std::string::npos);
  without.erase(feed, without.find('\n', feed) - feed);
  const auto path = temp_.write("no-feed.yaml", without);
  const std::string lines = "machine: " + path.string() + "\n";
  EXPECT_EQ(faultsOf(lines), "");
  EXPECT_THAT(faultsOf(lines + "belt: {drive: controller}\n"), HasSubstr("feed"));
}

TEST_F(CaseTest, EyeMarksThatOverlapAreAFault) {
  EXPECT_THAT(faultsOf("print: {eye_mark_length_mm: 70}\n"), HasSubstr("print.eye_mark_length_mm"));
}

}  // namespace
}  // namespace kerfbench::hil
