// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hil/fold/judge/fold_cameras.h"
#include "hil/inspect/space/space_checks.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::fold {

/// All that the bench knows of its instruments.
struct FoldInstruments {
  vision::CameraCalibration kerf;                 ///< Calibration of the kerf camera, over the table.
  vision::KerfScanOptions scan;                   ///< Station pitch: inspect::kEdgePitch_mm.
  std::vector<vision::CameraCalibration> survey;  ///< Calibrations over W's z = 0; see vision::SurveyView.
  inspect::SpaceInstruments space;
};

/// What was judged, and by which measurements.
struct FoldJudgement {
  inspect::SpaceResult result;
  std::vector<inspect::FaceEvidence> faces;
  std::vector<GrayImage> survey;  ///< For the report.
};

/// Photographs and measures the blank and judges the cut. A picture that is missing or not of its camera's
/// size makes the evidence INVALID.
FoldJudgement judgeFold(const inspect::SpaceJob& job, const std::vector<inspect::ContourPoint>& contour,
                        const FoldInstruments& instruments, const inspect::SpaceTolerances& limits,
                        FoldCameras& cameras, std::uint64_t seed);

}  // namespace kerfbench::fold
