// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/measured_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include <Eigen/LU>

#include "hil/base/yaml_reader.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

class MeasuredSheetFile : public testing::Test {
 protected:
  MeasuredSheetFile() {
    job_.marks = {{3, Vector2d(-40.0, 25.0)}, {4, Vector2d(50.0, 0.0)}};
    sheet_.digest = "abc";
    sheet_.missing = 1;
    sheet_.remarks = {"mark 5 is missing"};
    sheet_.pose_covariance << 1.1e-7, 1e-8, 3e-10, 1e-8, 2.3e-7, -1e-10, 3e-10, -1e-10, 4.7e-12;
    Eigen::Matrix2d own;
    own << 2e-8, 1e-9, 1e-9, 3e-8;
    sheet_.marks = {{job_.marks[0], Vector2d(-40.1234567890123, 25.0 / 3.0), own},
                    {job_.marks[1], Vector2d(50.01, -0.02), 2.0 * own}};
  }

  [[nodiscard]] std::filesystem::path written(const std::string& text) const {
    const std::filesystem::path path = temp_.path() / "measured.yaml";
    std::ofstream(path) << text;
    return path;
  }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    try {
      readMeasured(written(text), job_, "abc");
    } catch (const base::ConfigError& error) {
      return error.what();
    }
    return "";
  }

  base::TempFolder temp_;
  calibrate::MarkJob job_;
  MeasuredSheet sheet_;
};

TEST_F(MeasuredSheetFile, IsReadBackToTheLastBit) {
  const auto read = readMeasured(written(measuredText(sheet_)), job_, "abc");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->pose_covariance, sheet_.pose_covariance);
  ASSERT_EQ(read->marks.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read->marks[i].p_W_mm, sheet_.marks[i].p_W_mm);
    EXPECT_EQ(read->marks[i].covariance_mm2, sheet_.marks[i].covariance_mm2);
  }
  EXPECT_EQ(measuredText(*read), measuredText(sheet_));
  EXPECT_FALSE(readMeasured(temp_.path() / "measured.yaml", job_, "another digest"));
}

TEST_F(MeasuredSheetFile, OfAnotherVersionOrWithoutACovarianceIsRefused) {
  std::string text = measuredText(sheet_);
  const std::string version = "version: 2";
  text.replace(text.find(version), version.size(), "version: 1");
  EXPECT_THAT(refusal(text), HasSubstr("this program reads version 2; calibrate again"));
  sheet_.pose_covariance(2, 2) = -1e-12;
  EXPECT_THAT(refusal(measuredText(sheet_)), HasSubstr("pose_covariance: is no covariance"));
}

TEST_F(MeasuredSheetFile, ItsMarksShareThePose) {
  const std::vector<calibrate::HeadObservation> marks = observationsOf(sheet_, std::nullopt, 7);
  ASSERT_EQ(marks.size(), 2U);
  Eigen::Matrix<double, 2, 3> by_pose[2];
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(marks[i].shared->sheet, 7);
    const Vector2d& p = marks[i].measured_W_mm;
    by_pose[i] << 1.0, 0.0, -p.y(), 0.0, 1.0, p.x();
    EXPECT_EQ(marks[i].covariance_mm2, sheet_.marks[i].covariance_mm2);
  }
  const Eigen::Matrix2d between = by_pose[0] * sheet_.pose_covariance * by_pose[1].transpose();
  EXPECT_TRUE((marks[0].shared->modes_mm * marks[1].shared->modes_mm.transpose()).isApprox(between, 1e-9));
  const Eigen::Matrix2d whole =
      sheet_.marks[0].covariance_mm2 + by_pose[0] * sheet_.pose_covariance * by_pose[0].transpose();
  EXPECT_TRUE(marks[0].wholeCovariance_mm2().isApprox(whole, 1e-9));
}

}  // namespace
}  // namespace kerfbench::head_service
