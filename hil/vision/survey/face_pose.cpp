// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/survey/face_pose.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/vision/marks/mark_finder.h"
#include "hil/vision/survey/pose_solver.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

/// What a picture may leave of a disc's place, besides noise.
constexpr double kLeastSigma_px = 0.01;
constexpr std::size_t kLeastMarks = 3;
constexpr std::size_t kLeastViews = 2;

/// Looks for a face's marks in one view, near where they should be.
void sight(const ExpectedFace& face, const SurveyView& view, std::size_t number,
           std::vector<SightedMark>& sighted) {
  CameraCalibration over_face = *view.calibration;
  over_face.X_CP = view.calibration->X_CP * face.X_WF;
  // The normal points at the camera, or nothing of the print is seen.
  if (over_face.X_CP.linear().col(2).dot(over_face.X_CP.translation()) >= 0.0) return;
  for (std::size_t mark = 0; mark < face.print->marks.size(); ++mark) {
    const RegistrationMark& printed = face.print->marks[mark];
    const auto expected = over_face.pixelIfSeen(printed.p_SM_mm, 0.0);
    if (!expected) continue;
    const double px_per_mm = over_face.localMap(printed.p_SM_mm).pxPerMm();
    if (!over_face.pixelIfSeen(printed.p_SM_mm, markBorderPx(0.5 * printed.diameter_mm * px_per_mm)))
      continue;
    const auto found =
        measureMark(*view.image, over_face, printed.p_SM_mm, printed.diameter_mm, face.search_mm);
    if (!found) continue;
    const double sigma_px = found->sigma_mm * over_face.localMap(found->p_mm).pxPerMm();
    sighted.push_back(
        {number, mark, over_face.pixelFromPlane(found->p_mm), std::max(sigma_px, kLeastSigma_px)});
  }
}

}  // namespace

std::optional<FacePose> locateFace(const ExpectedFace& face, const std::vector<SurveyView>& views,
                                   std::vector<std::string>& problems) {
  const std::size_t marks = face.print->marks.size();
  if (marks < kLeastMarks) {
    problems.push_back(fmt::format("face {}: {} marks do not tell how it stands", face.name, marks));
    return std::nullopt;
  }
  std::vector<SightedMark> sighted;
  for (std::size_t i = 0; i < views.size(); ++i) sight(face, views[i], i, sighted);
  bool whole = true;
  for (std::size_t mark = 0; mark < marks; ++mark) {
    const auto seen = std::ranges::count_if(sighted, [&](const SightedMark& m) { return m.mark == mark; });
    if (static_cast<std::size_t>(seen) >= kLeastViews) continue;
    problems.push_back(
        fmt::format("face {}: mark {} is found in {} of {} survey pictures, and two are needed", face.name,
                    mark + 1, seen, views.size()));
    whole = false;
  }
  if (!whole) return std::nullopt;
  auto pose = solvePose(face, views, sighted);
  if (!pose) {
    problems.push_back(
        fmt::format("face {}: its marks fit no pose near the one that is expected", face.name));
    return std::nullopt;
  }
  if (!(pose->rms_px <= kMostRms_px)) {
    problems.push_back(fmt::format(
        "face {}: its marks lie {:.2f} px (RMS) off the best pose, where {:.2f} are allowed: it is "
        "not flat, or print or calibration is another",
        face.name, pose->rms_px, kMostRms_px));
    return std::nullopt;
  }
  return pose;
}

}  // namespace kerfbench::vision
