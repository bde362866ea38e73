// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/frame_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;
using testing::ElementsAre;
using testing::HasSubstr;

class FramePlan : public testing::Test {
 protected:
  FramePlan() {
    camera_.camera_id = "kerf-7";
    camera_.width_px = camera_.height_px = 1000;
    camera_.fx_px = camera_.fy_px = 1000.0;
    camera_.telecentric_mm = 30.0;
    camera_.X_CP.translation().z() = 30.0;
    camera_.area_mm = {Vector2d(-15.0, -14.0), Vector2d(15.5, 14.0)};
    job_.name = "1-grid";
    job_.machine = "m";
    job_.size_mm = 5.0;
    job_.p_SW_mm = {-67.0, 0.0};
    for (const double x : {-62.0, 1.0, 62.0})
      for (const double y : {-60.0, 60.0}) job_.print.push_back({job_.p_SW_mm + Vector2d(x, y), 3.0});
    job_.marks = calibrate::numbered(calibrate::gridPlaces({Vector2d(-50, -50), Vector2d(50, 50)}, 17), 0);
  }
  vision::CameraCalibration camera_;
  calibrate::MarkJob job_;
};

TEST_F(FramePlan, ShowsEachArmOfEachMarkAndEachPrintedMarkWholeInOnePicture) {
  const std::vector<ExpectedFrame> frames = expectedFrames(job_, camera_);
  const auto seen = [&](const Eigen::AlignedBox2d& box) {
    return std::ranges::any_of(frames,
                               [&](const ExpectedFrame& frame) { return frame.shows_mm.contains(box); });
  };
  for (const RegistrationMark& mark : job_.print) {
    const Vector2d radius = Vector2d::Constant(0.5 * mark.diameter_mm);
    EXPECT_TRUE(seen({mark.p_SM_mm - radius, mark.p_SM_mm + radius})) << mark.p_SM_mm.transpose();
  }
  for (const calibrate::WantedMark& mark : job_.marks) {
    for (const calibrate::MarkStroke& arm : calibrate::markArms(job_.size_mm)) {
      Eigen::AlignedBox2d box(job_.wanted_S_mm(mark) + arm.from_mm);
      box.extend(job_.wanted_S_mm(mark) + arm.to_mm);
      EXPECT_TRUE(seen(box)) << mark.number;
    }
  }
  // Row by row to and fro: the table never goes all the way back.
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Vector2d way = frames[i].p_TV_mm - frames[i - 1].p_TV_mm;
    EXPECT_EQ((way.array().abs() > 1e-9).count(), 1) << i;
  }
}

TEST_F(FramePlan, ATemplateIsAListOfPicturesAndTellsWhatIsMissing) {
  const base::TempFolder temp;
  const std::vector<ExpectedFrame> frames = expectedFrames(job_, camera_);
  const std::string text = tilesTemplate(job_, camera_, frames);
  EXPECT_THAT(text, HasSubstr("kerf-7, 1000 x 1000 pixels of 0.03000 mm"));
  EXPECT_THAT(text, HasSubstr("# Shows x "));
  std::ofstream(temp.path() / "tiles.yaml") << text;
  EXPECT_TRUE(framesIn(temp.path()).none());
  EXPECT_EQ(framesIn(temp.path()).named, frames.size());
  for (const ExpectedFrame& frame : frames)
    if (frame.file != "tile-0003.png") std::ofstream(temp.path() / frame.file) << "picture";
  std::ofstream(temp.path() / "IMG_1.jpg") << "picture";
  const FolderOfFrames found = framesIn(temp.path());
  EXPECT_THAT(found.missing, ElementsAre("tile-0003.png"));
  EXPECT_THAT(found.unnamed, ElementsAre("IMG_1.jpg"));
  EXPECT_FALSE(found.none() || found.whole());
}

}  // namespace
}  // namespace kerfbench::head_service
