// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/judge/fold_judge.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "hil/camera/kerf_tile.h"
#include "hil/vision/scan/kerf_scan.h"
#include "hil/vision/survey/face_pose.h"

namespace kerfbench::fold {
namespace {

/// No pictures at all.
class NoTiles final : public camera::TileSource {
 public:
  std::vector<camera::KerfTile> nextBatch(std::size_t) override { return {}; }
};

/// Views of the pictures that can be used.
std::vector<vision::SurveyView> viewsOf(const std::vector<GrayImage>& pictures,
                                        const std::vector<vision::CameraCalibration>& calibrations,
                                        std::vector<std::string>& problems) {
  std::vector<vision::SurveyView> views;
  for (std::size_t i = 0; i < calibrations.size(); ++i) {
    const vision::CameraCalibration& calibration = calibrations[i];
    if (i >= pictures.size() || pictures[i].width == 0) {
      problems.push_back(fmt::format("survey camera {}: no picture", calibration.camera_id));
      continue;
    }
    if (pictures[i].width != calibration.width_px || pictures[i].height != calibration.height_px) {
      problems.push_back(fmt::format("survey camera {}: its picture has {} x {} pixels, its calibration {} x {}",
                                     calibration.camera_id, pictures[i].width, pictures[i].height,
                                     calibration.width_px, calibration.height_px));
      continue;
    }
    views.push_back({&calibration, &pictures[i]});
  }
  return views;
}

}  // namespace

FoldJudgement judgeFold(const inspect::SpaceJob& job, const std::vector<inspect::ContourPoint>& contour,
                        const FoldInstruments& instruments, const inspect::SpaceTolerances& limits,
                        FoldCameras& cameras, std::uint64_t seed) {
  FoldJudgement judgement;
  judgement.survey = cameras.surveyPictures();
  std::vector<std::string> problems;
  const std::vector<vision::SurveyView> views = viewsOf(judgement.survey, instruments.survey, problems);
  for (std::size_t i = 0; i < job.faces.size(); ++i) {
    const inspect::SpaceFace& face = job.faces[i];
    inspect::FaceEvidence& evidence = judgement.faces.emplace_back();
    const inspect::FacePlan plan = inspect::planFace(job, i);
    if (plan.lines.empty()) continue;
    vision::ExpectedFace expected;
    expected.name = face.name;
    expected.X_WF = face.X_WF;
    expected.print = &face.print;
    expected.print_sigma_mm = instruments.scan.print_sigma_mm;
    evidence.pose = vision::locateFace(expected, views, problems);
    std::unique_ptr<camera::TileSource> tiles = cameras.kerfTiles(i);
    if (!tiles) tiles = std::make_unique<NoTiles>();
    evidence.scan =
        vision::scanKerf(*tiles, instruments.kerf, face.print, *plan.dieline, instruments.scan);
  }
  judgement.result =
      inspect::judgeInSpace(job, contour, judgement.faces, instruments.space, limits, seed);
  std::vector<std::string>& all = judgement.result.problems;
  all.insert(all.begin(), problems.begin(), problems.end());
  if (!problems.empty()) judgement.result.verdict = inspect::Verdict::kInvalid;
  return judgement;
}

}  // namespace kerfbench::fold
