// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/camera_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::scenario {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class CameraFiles : public testing::Test {
 protected:
  void SetUp() override { (void)temp_.write("controller-avr.hex", ":00000001FF\n"); }
  /// Case of the label job on a machine of its own: these lines in the scenario, these keys under
  /// cameras.spot.
  Case label(const std::string& scenario_lines, const std::string& spot_keys = "") const {
    const auto machine =
        temp_.write("m.yaml", "extends: " + base::fixture("machines/two-mirror.yaml").string() + "\n" +
                                  (spot_keys.empty() ? "" : "cameras: {spot: {" + spot_keys + "}}\n"));
    return readCase(
        temp_.write("s.yaml", "extends: " + base::fixture("scenarios/label-on-belt.yaml").string() +
                                  "\nname: changed\nmachine: " + machine.string() + "\n" + scenario_lines),
        temp_.path());
  }
  /// Calibration of the spot camera with the value of a key changed; its name.
  std::string calibration(const std::string& key, const std::string& value) const {
    const std::string text = base::contentOf(base::fixture("machines/two-mirror.spot.camera.yaml"));
    return temp_.write("changed.yaml", base::withValue(text, key, value)).string();
  }
  static std::vector<std::string> problemsOf(const Case& test_case) {
    return readCalibrations(test_case).problems;
  }
  const base::TempFolder temp_;
};

TEST_F(CameraFiles, TheHousesMachinesAreCalibrated) {
  const BenchCameras cameras = readCalibrations(label(""));
  EXPECT_THAT(cameras.problems, ElementsAre());
  ASSERT_TRUE(cameras.spot && cameras.kerf);
  EXPECT_EQ(cameras.spot->camera_id, "two-mirror-spot");
  EXPECT_EQ(cameras.kerf->camera_id, "two-mirror-kerf");
  ASSERT_EQ(cameras.facts.size(), 2U);
  EXPECT_THAT(cameras.facts[0].second, HasSubstr("calibrated 2026-11-20"));
}

TEST_F(CameraFiles, AMissingOneIsAProblemThatSaysWhatToRun) {
  const auto problems = problemsOf(label("", "calibration: none.yaml"));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_THAT(problems[0], AllOf(HasSubstr("spot camera"), HasSubstr("none.yaml is missing"),
                                 HasSubstr("./bench calibrate camera --machine"),
                                 HasSubstr("m.yaml --camera spot --date DAY")));
}

TEST_F(CameraFiles, OfBothCamerasAllProblemsAreTold) {
  const Case test_case = label("date: 2026-11-01\n");
  const BenchCameras cameras = readCalibrations(test_case);
  EXPECT_EQ(cameras.problems.size(), 2U);
  EXPECT_FALSE(cameras.spot || cameras.kerf);
}

TEST_F(CameraFiles, OneThatCannotBeReadIsAProblem) {
  (void)temp_.write("torn.yaml", "version: 1\ncamera_id: x\n");
  EXPECT_THAT(
      problemsOf(label("", "calibration: torn.yaml")),
      ElementsAre(AllOf(HasSubstr("cannot be used"), HasSubstr("focal_px"), HasSubstr("error_modes"))));
}

TEST_F(CameraFiles, OneOfAnotherCameraIsAProblem) {
  EXPECT_THAT(problemsOf(label("", "id: 'serial 1234'")),
              ElementsAre(HasSubstr("is of another camera: 'two-mirror-spot', not 'serial 1234'")));
  EXPECT_THAT(problemsOf(label("", "calibration: " + calibration("size_px", "[1800, 1801]"))),
              ElementsAre(HasSubstr("is of another camera: of 1800 x 1801 pixels, not 1800 x 1800")));
}

TEST_F(CameraFiles, ACameraThatWasMovedNeedsAnother) {
  for (const char* moved : {"tilt_deg: 3.001", "height_mm: 1000.01", "centre_mm: [0.001, 0]",
                            "pitch_mm: 0.1001", "distortion: [-0.0501, 0, 0, 0, 0]"})
    EXPECT_THAT(problemsOf(label("", moved)), ElementsAre(HasSubstr("is stale: the machine file describes")))
        << moved;
  for (const char* other : {"psf_sigma_px: 0.7", "bits: 10", "exposure_us: 100", "texture: {grain_gray: 3}"})
    EXPECT_THAT(problemsOf(label("", other)), ElementsAre()) << other;
}

TEST_F(CameraFiles, AgeCountsFromTheScenariosDateAndNoClock) {
  EXPECT_THAT(problemsOf(label("date: 2026-11-20\n")), ElementsAre());
  EXPECT_THAT(problemsOf(label("date: 2027-05-19\n")), ElementsAre());  // 180 days.
  EXPECT_THAT(problemsOf(label("date: 2027-05-20\n")),
              ElementsAre(HasSubstr("is stale: of 2026-11-20, 181 days before"), HasSubstr("kerf camera")));
  EXPECT_THAT(problemsOf(label("date: 2027-05-20\nchecks: {calibration_max_age_days: 181}\n")),
              ElementsAre());
  EXPECT_THAT(problemsOf(label("date: 2026-11-19\n")),
              ElementsAre(HasSubstr("is of 2026-11-20, after the run's date 2026-11-19"), HasSubstr("kerf")));
  // Without a date in the scenario the calibration is used on its own day, however old.
  EXPECT_THAT(problemsOf(label("", "calibration: " + calibration("date", "1999-01-01"))), ElementsAre());
}

TEST_F(CameraFiles, WithoutAKeyItLiesBesideTheMachineFile) {
  const Case test_case = label("", "calibration: ~, id: ~");
  EXPECT_EQ(test_case.spot_camera.calibration, temp_.path() / "m.spot.camera.yaml");
  EXPECT_EQ(test_case.spot_camera.id, "spot");
  EXPECT_TRUE(test_case.spot_camera.named_here);
  EXPECT_FALSE(test_case.kerf_camera.named_here);
}

TEST_F(CameraFiles, ADateThatIsNoneIsAFaultOfTheScenario) {
  EXPECT_THROW((void)label("date: 20.11.2026\n"), base::ConfigError);
  EXPECT_THROW((void)label("checks: {calibration_max_age_days: -1}\n"), base::ConfigError);
}

}  // namespace
}  // namespace kerfbench::scenario
