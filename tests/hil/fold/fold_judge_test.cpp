// SPDX-License-Identifier: Apache-2.0
// The judge with cameras that fail: no picture, no verdict.
#include "hil/fold/judge/fold_judge.h"

#include <utility>

#include <gtest/gtest.h>

#include "hil/fold/fold_scenario.h"
#include "hil/fold/fold_twin.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::fold {
namespace {

/// Cameras of which some pictures are lost.
class LosingCameras final : public FoldCameras {
 public:
  explicit LosingCameras(FoldCameras& cameras) : cameras_(cameras) {}
  std::vector<GrayImage> surveyPictures() override {
    std::vector<GrayImage> pictures = cameras_.surveyPictures();
    if (lost_survey >= 0) pictures[static_cast<std::size_t>(lost_survey)] = GrayImage();
    if (wrong_survey) pictures[0] = GrayImage(100, 100, 130);
    return pictures;
  }
  std::unique_ptr<camera::TileSource> kerfTiles(std::size_t face) override {
    return face == lost_face ? nullptr : cameras_.kerfTiles(face);
  }
  int lost_survey{-1};
  bool wrong_survey{};
  std::size_t lost_face{99};

 private:
  FoldCameras& cameras_;
};

class FoldJudge : public testing::Test {
 protected:
  FoldJudge()
      : scenario_(readFoldScenario(base::fixture("fold/shallow-edge.yaml"))),
        cut_(cutOnTwin(scenario_)),
        twin_(scenario_, cut_, 1),
        cameras_(twin_) {}
  FoldJudgement judge() {
    return judgeFold(scenario_.job, scenario_.contour, instrumentsOf(scenario_, 1), scenario_.limits,
                     cameras_, scenario_.seed);
  }
  FoldScenario scenario_;
  twin::FoldedCut cut_;
  TwinFoldCameras twin_;
  LosingCameras cameras_;
};

TEST_F(FoldJudge, ALostSurveyPictureMakesTheEvidenceInvalid) {
  cameras_.lost_survey = 1;
  const FoldJudgement judgement = judge();
  EXPECT_EQ(judgement.result.verdict, inspect::Verdict::kInvalid);
  EXPECT_EQ(judgement.result.problems.front(), "survey camera survey-right: no picture");
}

TEST_F(FoldJudge, APictureOfAnotherCameraMakesTheEvidenceInvalid) {
  cameras_.wrong_survey = true;
  EXPECT_EQ(judge().result.verdict, inspect::Verdict::kInvalid);
}

TEST_F(FoldJudge, ALostKerfPictureMakesTheEvidenceInvalid) {
  cameras_.lost_face = 1;
  EXPECT_EQ(judge().result.verdict, inspect::Verdict::kInvalid);
}

TEST(FoldJudgeOfOneFace, ABurnOnAFaceWithoutAContourFails) {
  const base::TempFolder temp;
  (void)temp.write("line.xyz", "20 22 0 0 0 1\n20 48 0 0 0 1\n");
  const std::string cut = "G00 X19.8 Y22 Z0 A0 C0\nG01 Y48\n";
  const std::string burn = "G00 X48.6603 Y40 Z-5 A30 C90\nG01 Y44\n";
  for (const bool burns : {false, true}) {
    (void)temp.write("p.gcode", burns ? cut + burn : cut);
    const FoldScenario scenario = readFoldScenario(
        temp.write("s.yaml", "extends: '" + base::fixture("fold/shallow-edge.yaml").string() +
                                 "'\nname: s\ncontour: line.xyz\nprogram: {gcode: p.gcode}\n"));
    const twin::FoldedCut done = cutOnTwin(scenario);
    TwinFoldCameras cameras(scenario, done, 1);
    const inspect::SpaceResult result = judgeFold(scenario.job, scenario.contour, instrumentsOf(scenario, 1),
                                                  scenario.limits, cameras, scenario.seed)
                                            .result;
    EXPECT_EQ(result.verdict, burns ? inspect::Verdict::kFail : inspect::Verdict::kPass);
    EXPECT_EQ(result.checks.back().name, "space_stray");
    EXPECT_EQ(result.checks.back().verdict, burns ? inspect::Verdict::kFail : inspect::Verdict::kPass);
  }
}

TEST_F(FoldJudge, PosesAndEdgesAreThoseOfTheModelWithinTheirUncertainty) {
  const FoldJudgement judgement = judge();
  ASSERT_EQ(judgement.result.verdict, inspect::Verdict::kPass);
  for (std::size_t face = 0; face < 2; ++face) {
    const vision::FacePose& pose = judgement.faces[face].pose.value();
    const Eigen::Vector3d p_F(20.0, 20.0, 0.0);
    const Eigen::Vector3d error = pose.X_WF * p_F - scenario_.blank.standing[face].X_WF * p_F;
    double variance = 0.0;
    for (const vision::SmallMotion& mode : pose.modes)
      variance += pose.shift(mode, pose.X_WF * p_F).squaredNorm();
    EXPECT_LT(error.norm(), 2.0 * std::sqrt(variance));
  }
}

}  // namespace
}  // namespace kerfbench::fold
