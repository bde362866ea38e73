// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/image_fit.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/suite/plan.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

fs::path built(const char* name) { return fs::path(KERFBENCH_BINARY_DIR) / "firmware" / name; }

/// Why an image does not fit the controller of a scenario.
std::string whyNot(const char* scenario, const fs::path& image) {
  const fs::path bin = fs::path(KERFBENCH_BINARY_DIR) / "bin";
  const auto read = scenario::readScenario(base::fixture(std::string("scenarios/") + scenario),
                                           {bin.parent_path() / "firmware", image});
  return whyImageDoesNotFit(read.firmware, bin);
}

constexpr const char* kAvr = "label-on-belt.yaml";
constexpr const char* kMcs51 = "mcs51/label-on-belt.yaml";
constexpr const char* kStm32 = "stm32/label-on-belt.yaml";
constexpr const char* kNative = "native/label-on-belt.yaml";

TEST(ImageFit, EachControllerTakesItsOwn) {
  EXPECT_THAT(whyNot(kAvr, built("controller-avr.hex")), IsEmpty());
  EXPECT_THAT(whyNot(kAvr, built("controller-avr.elf")), IsEmpty());
  EXPECT_THAT(whyNot(kMcs51, built("controller-mcs51.hex")), IsEmpty());
  EXPECT_THAT(whyNot(kStm32, built("controller-stm32.hex")), IsEmpty());
  EXPECT_THAT(whyNot(kStm32, built("controller-stm32.elf")), IsEmpty());
  EXPECT_THAT(whyNot(kNative, built("controller-native")), IsEmpty());
}

TEST(ImageFit, NoneTakesThatOfAnother) {
  EXPECT_THAT(whyNot(kAvr, built("controller-mcs51.hex")), HasSubstr("begins with a jump of an 8051"));
  EXPECT_THAT(whyNot(kMcs51, built("controller-avr.hex")), HasSubstr("begins with a jump of an AVR"));
  EXPECT_THAT(whyNot(kAvr, built("controller-stm32.elf")), HasSubstr("not for an AVR"));
  EXPECT_THAT(whyNot(kStm32, built("controller-avr.elf")), HasSubstr("not for"));
  EXPECT_THAT(whyNot(kAvr, built("controller-stm32.hex")), HasSubstr("outside the controller's memory"));
  for (const char* image : {"controller-avr.hex", "controller-mcs51.hex", "controller-native"})
    EXPECT_THAT(whyNot(kStm32, built(image)), testing::Not(IsEmpty())) << image;
  for (const char* image : {"controller-avr.hex", "controller-stm32.elf"})
    EXPECT_THAT(whyNot(kNative, built(image)), testing::Not(IsEmpty())) << image;
}

TEST(ImageFit, AFileThatIsNoImageFitsNone) {
  const base::TempFolder temp;
  const fs::path text = temp.write("release.hex", "not yet built\n");
  for (const char* scenario : {kAvr, kMcs51, kNative})
    EXPECT_THAT(whyNot(scenario, text), testing::Not(IsEmpty())) << scenario;
}

TEST(ShippedPlans, CanBeReadAndTheirImagesFit) {
  const fs::path bin = fs::path(KERFBENCH_BINARY_DIR) / "bin";
  const fs::path release = bin.parent_path() / "firmware/controller-avr.elf";
  const Plan plan = readPlan(base::fixture("suites/label-release.yaml"), {bin, release});
  EXPECT_NO_THROW(refuseUnfit(plan));
  EXPECT_GE(plan.runs.size(), 5U);
}

}  // namespace
}  // namespace kerfbench::suite
