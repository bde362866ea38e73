// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/judge/fold_judge.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "hil/camera/kerf_tile.h"
#include "hil/vision/scan/kerf_scan.h"
#include "hil/vision/survey/face_pose.h"

namespace kerfbench::fold {
namespace {

/// Pictures that were taken, to be looked at more than once.
class TakenTiles final : public camera::TileSource {
 public:
  explicit TakenTiles(std::vector<camera::KerfTile> tiles) : tiles_(std::move(tiles)) {}
  std::vector<camera::KerfTile> nextBatch(std::size_t) override { return std::exchange(tiles_, {}); }

 private:
  std::vector<camera::KerfTile> tiles_;
};

std::vector<camera::KerfTile> takeAll(std::unique_ptr<camera::TileSource> source) {
  constexpr std::size_t kBatch = 16;
  std::vector<camera::KerfTile> all;
  while (source) {
    std::vector<camera::KerfTile> batch = source->nextBatch(kBatch);
    if (batch.empty()) break;
    std::ranges::move(batch, std::back_inserter(all));
  }
  return all;
}

vision::KerfScan scanOf(std::vector<camera::KerfTile> tiles, const inspect::SpaceFace& face,
                        const inspect::FaceDrawing& drawing, const FoldInstruments& instruments) {
  TakenTiles source(std::move(tiles));
  return vision::scanKerf(source, instruments.kerf, face.print, *drawing.dieline, instruments.scan);
}

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
      problems.push_back(fmt::format(
          "survey camera {}: its picture has {} x {} pixels, its calibration {} x {}", calibration.camera_id,
          pictures[i].width, pictures[i].height, calibration.width_px, calibration.height_px));
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
    // On a face without a line of the contour nothing may be burnt, however it stood.
    if (!plan.kerfs.lines.empty()) {
      vision::ExpectedFace expected;
      expected.name = face.name;
      expected.X_WF = face.X_WF;
      expected.print = &face.print;
      expected.print_sigma_mm = instruments.scan.print_sigma_mm;
      evidence.pose = vision::locateFace(expected, views, problems);
    }
    std::vector<camera::KerfTile> tiles = takeAll(cameras.kerfTiles(i));
    if (!plan.beyond.lines.empty()) evidence.beyond = scanOf(tiles, face, plan.beyond, instruments);
    evidence.scan = scanOf(std::move(tiles), face, plan.kerfs, instruments);
  }
  judgement.result = inspect::judgeInSpace(job, contour, judgement.faces, instruments.space, limits, seed);
  std::vector<std::string>& all = judgement.result.problems;
  all.insert(all.begin(), problems.begin(), problems.end());
  if (!problems.empty()) judgement.result.verdict = inspect::Verdict::kInvalid;
  return judgement;
}

}  // namespace kerfbench::fold
