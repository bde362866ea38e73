// SPDX-License-Identifier: Apache-2.0
// Whether the cameras can tell what they are asked: outside of what was calibrated, or through walls, they
// cannot.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/deviation/error_model.h"

namespace kerfbench::inspect::checks {
namespace {

/// Share of the path's limit that the camera's aslant sight of thick board may leave uncertain.
constexpr double kMostBySight = 0.5;
/// RMS of tiles' shifts against each other over what the inspection table is said to do.
constexpr double kMostMisfit = 3.0;
constexpr double kLeastMisfit_mm = 0.003;  ///< What the pictures themselves may leave.

/// Whether the kerf's place can be told at all from pictures of this board by this camera, on this table.
void addSightDoubts(const Evidence& evidence, const Tolerances& limits, std::vector<std::string>& doubts) {
  const vision::CameraCalibration& camera = *evidence.kerf_calibration;
  double most_mm = 0.0;
  double steepest = 0.0;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    for (const vision::Caliper& c : kerf.calipers) {
      if (!judgesOffset(c)) continue;
      const double slope = camera.sightSlope(c.p_V_mm).norm();
      most_mm =
          std::max(most_mm, 2.0 * kerf.depth_sigma_mm * slope + kerf.deepest_mm() * camera.square_within_rad);
      steepest = std::max({steepest, slope, camera.square_within_rad});
    }
  }
  if (most_mm > kMostBySight * limits.path_mm) {
    doubts.push_back(fmt::format(
        "The kerf camera looks at the board at up to {:.1f}°, so that its walls leave kerfs uncertain by "
        "{:.4f} "
        "mm, more than {:g} % of the path's limit: it takes a telecentric lens, smaller tiles, or tiles that "
        "overlap.",
        180.0 / std::numbers::pi * std::atan(steepest), most_mm, 100.0 * kMostBySight));
  }
  const double misfit_mm = evidence.kerf.tile_misfit_mm;
  const double table_mm = evidence.kerf.table_sigma_mm;
  if (misfit_mm > std::max(kMostMisfit * table_mm, kLeastMisfit_mm)) {
    doubts.push_back(fmt::format(
        "The same kerfs and marks lie {:.4f} mm (RMS) apart in overlapping tiles, where the "
        "inspection table is said to stop within {:.4f} mm: table, camera scale or tiles.yaml are "
        "wrong.",
        misfit_mm, table_mm));
  }
}

}  // namespace

std::vector<std::string> doubtsOf(const Evidence& evidence, const LitFrames& lit, const Tolerances& limits) {
  std::vector<std::string> doubts;
  if (evidence.spot_calibration) {
    const auto outside = std::count_if(lit.frames.begin(), lit.frames.end(), [&](const LitFrame& f) {
      const auto& spot_W_mm = evidence.spot.frames[f.frame].spot_W_mm;
      return spot_W_mm && !evidence.spot_calibration->area_mm.contains(*spot_W_mm);
    });
    if (outside > 0) {
      doubts.push_back(fmt::format(
          "In {} frames the spot lies outside the area that the spot camera's calibration covers.", outside));
    }
  }
  if (!evidence.kerf_calibration) return doubts;
  addSightDoubts(evidence, limits, doubts);
  std::size_t outside = 0;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    outside += static_cast<std::size_t>(std::ranges::count_if(kerf.calipers, [&](const vision::Caliper& c) {
      return judgesOffset(c) && !evidence.kerf_calibration->area_mm.contains(c.p_V_mm);
    }));
  }
  if (outside > 0) {
    doubts.push_back(
        fmt::format("{} readings lie outside the area that the kerf camera's calibration covers.", outside));
  }
  return doubts;
}

}  // namespace kerfbench::inspect::checks
