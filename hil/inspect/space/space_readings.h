// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/inspect/space/space_job.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "hil/vision/survey/face_pose.h"

namespace kerfbench::inspect {

/// What was measured of one face: its kerfs, in F, by the kerf camera; how it stood, by the survey cameras.
struct FaceEvidence {
  vision::KerfScan scan;    ///< Scan of FacePlan::kerfs.
  vision::KerfScan beyond;  ///< Scan of FacePlan::beyond in the same pictures; empty where that is.
  std::optional<vision::FacePose> pose;
};

/// What the instruments leave open, from data sheets and calibrations.
struct SpaceInstruments {
  double beam_radius_mm{};      ///< 1/e² radius of the beam on the board.
  double board_transmission{};  ///< Share of the back light through whole board.
  double kerf_map_u_mm{};  ///< Standard uncertainty of a place by the kerf camera's calibration, per axis.
};

/// Where a reading lies on its line.
enum class EdgeZone {
  kAlong,  ///< The edge must lie on the contour.
  kJoint,  ///< Near a fold or a corner: the kerf's edge may lie off the contour, but not within the piece.
  kEnd     ///< Near a free end of the contour: read for coverage alone.
};

/// Share of the error modes of a reading by their source.
enum EdgeSource : std::size_t { kBySurvey, kByKerfPose, kByKerfWidth, kByKerfScale, kBySteady, kEdgeSources };

/// The edge of the piece at one place of the contour.
struct EdgeReading {
  std::size_t line{};  ///< Index in SpaceJob::lines.
  double way_mm{};     ///< Along the line.
  EdgeZone zone{EdgeZone::kAlong};
  bool strict{};  ///< The strict offset lies in the face here, so that the kerf must be there.
  bool found{};   ///< There is a kerf, and `edge_W_mm` is a place.
  bool open{};    ///< The board is cut through.
  Eigen::Vector3d edge_W_mm{Eigen::Vector3d::Zero()};
  /// From the line of the contour in space to the edge, at a right angle to the line: in the face towards the
  /// kerf (< 0: into the piece), and along the face's normal as it is drawn. NaN unless found.
  double beside_mm{}, above_mm{};
  double half_mm{};  ///< Half of the severed width.
  /// Bound (k = 2) of -beside_mm by where light comes through: the board is severed no farther than that.
  double most_lost_mm{};
  double noise_mm{};  ///< Standard deviation of beside_mm that no other reading has in common.
  /// What a standard deviation of each shared error moves both by; errors of one face are in common.
  Eigen::VectorXd beside_modes, above_modes;
  std::vector<EdgeSource> sources;  ///< Source of each mode.

  [[nodiscard]] double distance_mm() const;
};

/// Distance of readings along a line.
inline constexpr double kEdgePitch_mm = 0.1;

/// Reads the edge at every caliper that lies along the contour. The severed edge of a kerf is as edgeScan()
/// has it: the middle, less half the severed width on the piece's side.
std::vector<EdgeReading> readEdges(const SpaceJob& job, const std::vector<FaceEvidence>& faces,
                                   const std::vector<ContourPoint>& contour,
                                   const SpaceInstruments& instruments);

}  // namespace kerfbench::inspect
