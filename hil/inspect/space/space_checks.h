// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/inspect/space/space_job.h"
#include "hil/inspect/space/space_readings.h"
#include "hil/inspect/space/worst_distance.h"
#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::inspect {

/// What a cut in space may be off.
struct SpaceTolerances {
  double path_mm{0.05};  ///< Distance of the piece's edge from the contour's line in space.
  double burn_mm{0.05};  ///< How far the kerf may reach into the piece near folds and corners.
  double uncut_mm{0.5};  ///< Longest stretch of the contour that is not cut through.
  double stray_mm{0.5};  ///< Longest burnt place away from the kerf.
};

/// The verdict on a contour in space, with what it rests on.
struct SpaceResult {
  Verdict verdict{Verdict::kInvalid};
  std::vector<Check> checks;  ///< "space_path", "space_joints", "space_coverage", "space_stray"
  std::vector<EdgeReading> readings;
  WorstDistance worst;
  std::vector<std::string> problems;  ///< Reasons not to trust the evidence.
};

/// Judges what was measured of all faces. A face that was not placed, or a scan with problems, is INVALID.
///
/// space_path: worstDistance(). space_joints: how far the kerf reaches beyond the contour into the piece
/// within EdgeZone::kJoint, in the face's plane; there the path leaves the strict offset (Chi et al. 2014,
/// 1.2.2), so that more board may be left, but none lost. space_coverage: longest stretch of readings without
/// a kerf that is cut through, where a strict offset lies in the face. space_stray: longest burnt place
/// within the faces' outlines that is neither the kerf nor, near a fold and on the kerf's side of the
/// contour, what the joint leads the beam to.
SpaceResult judgeInSpace(const SpaceJob& job, const std::vector<ContourPoint>& contour,
                         const std::vector<FaceEvidence>& faces, const SpaceInstruments& instruments,
                         const SpaceTolerances& limits, std::uint64_t seed);

}  // namespace kerfbench::inspect
