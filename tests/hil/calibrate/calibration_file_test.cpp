// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/calibrate/small_camera.h"

namespace kerfbench::calibrate {
namespace {

using testing::HasSubstr;

CalibrationFile sample() {
  const CameraCalibrationResult result = calibrateCamera(test::smallJob(7, 3));
  return {result.calibration, "0123456789abcdef", result.views.size(), result.corners};
}

class CalibrationFiles : public testing::Test {
 protected:
  static void SetUpTestSuite() { text_ = calibrationText(sample(), "a test"); }
  std::string faultsOf(const std::string& text) const {
    try {
      (void)readCalibrationFile(temp_.write("c.yaml", text));
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
  inline static std::string text_;
  const base::TempFolder temp_;
};

TEST_F(CalibrationFiles, ComeBackAsTheyWere) {
  const CalibrationFile file = sample();
  const CalibrationFile read = readCalibrationFile(temp_.write("c.yaml", calibrationText(file, "a test")));
  const vision::CameraCalibration& a = file.calibration;
  const vision::CameraCalibration& b = read.calibration;
  EXPECT_EQ(b.camera_id, "small");
  EXPECT_EQ(b.date, "2026-11-20");
  EXPECT_EQ(read.described_camera, "0123456789abcdef");
  EXPECT_EQ(read.views, 4U);
  EXPECT_EQ(read.corners, file.corners);
  EXPECT_EQ(b.width_px, a.width_px);
  EXPECT_EQ(b.height_px, a.height_px);
  EXPECT_NEAR(b.rms_px, a.rms_px, 1e-8);
  EXPECT_NEAR(b.map_u_mm, a.map_u_mm, 1e-8);
  ASSERT_EQ(b.error_modes.size(), a.error_modes.size());
  // The map is the same to a nanometre, and nothing else counts.
  EXPECT_LT(test::largest(test::mapErrors(b, a, 10)), 1e-7);
  for (std::size_t k = 0; k < a.error_modes.size(); ++k)
    EXPECT_LT((b.mapError(k, {5.0, -4.0}) - a.mapError(k, {5.0, -4.0})).norm(), 1e-9) << k;
  EXPECT_EQ(calibrationText(read, "a test"), calibrationText(file, "a test"));
}

TEST_F(CalibrationFiles, EveryFaultIsNamed) {
  EXPECT_EQ(faultsOf(text_), "");
  std::string bad = base::withValue(base::withValue(text_, "date", "20.11.2026"), "focal_px", "[2500, .nan]");
  bad = base::withValue(base::withValue(bad, "size_px", "[560.5, 440]"), "rms_px", "-1");
  const std::string faults = faultsOf(bad + "more: 1\n");
  for (const char* key : {"date", "focal_px", "size_px", "rms_px", "more: unknown key"})
    EXPECT_THAT(faults, HasSubstr(key));
}

TEST_F(CalibrationFiles, NothingThatIsNotANumberGetsIn) {
  for (const char* key : {"focal_px", "principal_px", "distortion", "rotation_vector_rad", "translation_mm",
                          "area_min_mm", "area_max_mm", "parameters"}) {
    const std::string line = text_.substr(text_.find(std::string(key) + ": ["));
    const std::string list = line.substr(line.find('['), line.find(']') - line.find('[') + 1);
    for (const char* value : {".nan", ".inf", "x"}) {
      const std::string spoilt = "[" + std::string(value) + list.substr(list.find(','));
      EXPECT_THAT(
          faultsOf(base::replaced(text_, std::string(key) + ": " + list, std::string(key) + ": " + spoilt)),
          HasSubstr(key))
          << value;
    }
  }
  EXPECT_THAT(faultsOf(base::withValue(text_, "map_u_mm", ".nan")), HasSubstr("map_u_mm"));
}

TEST_F(CalibrationFiles, ACalibrationWithoutUncertaintyIsNone) {
  EXPECT_THAT(faultsOf(text_.substr(0, text_.find("error_modes:")) + "error_modes: []\n"),
              HasSubstr("error_modes"));
  EXPECT_THAT(faultsOf(base::withValue(text_, "map_u_mm", "0")), HasSubstr("map_u_mm"));
}

TEST_F(CalibrationFiles, HalfAFileOrNoneIsRefused) {
  EXPECT_NE(faultsOf(text_.substr(0, text_.size() / 2)), "");
  EXPECT_NE(faultsOf(""), "");
  EXPECT_THROW((void)readCalibrationFile(temp_.path() / "none.yaml"), base::ConfigError);
}

}  // namespace
}  // namespace kerfbench::calibrate
