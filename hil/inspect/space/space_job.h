// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/dieline/process.h"
#include "hil/inspect/space/contour_file.h"
#include "twin/base/print_layout.h"

namespace kerfbench::inspect {

/// A face of the folded blank as it is drawn: where it should stand, and its print. F is its frame: z is the
/// normal towards the head.
struct SpaceFace {
  std::string name;
  Eigen::Isometry3d X_WF{Eigen::Isometry3d::Identity()};
  Eigen::AlignedBox2d outline_F_mm;
  PrintLayout print;
};

/// What an end of a line of the contour is.
enum class LineEndKind {
  kFree,    ///< The contour begins or ends there.
  kCorner,  ///< The contour turns within the face.
  kFold     ///< The contour goes on in another face.
};

/// A line of the contour, in the face that it lies in.
struct SpaceLine {
  std::size_t face{};
  std::size_t point{};  ///< Point of the contour at which it begins.
  Eigen::Vector2d from_F_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d to_F_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d along_F{Eigen::Vector2d::UnitX()};   ///< Unit vector from begin to end.
  Eigen::Vector2d beside_F{Eigen::Vector2d::UnitY()};  ///< Unit vector towards the kerf.
  double length_mm{};
  LineEndKind begin{LineEndKind::kFree}, end{LineEndKind::kFree};
  /// Where the strict offset of the line lies in the face: way along the line, from `from_F_mm` on. At an
  /// obtuse angle to a fold it leaves the face before the line ends.
  double kerf_from_mm{}, kerf_to_mm{};
};

/// A contour over the faces of a blank, and where its kerf is to lie.
struct SpaceJob {
  std::vector<SpaceFace> faces;
  std::vector<SpaceLine> lines;
  double kerf_radius_mm{};  ///< Half the width of the kerf, as ordered.
  double side{1.0};         ///< +1: the kerf lies left of the contour as seen from the head; -1: right.
};

/// Lays each line of a contour into its face. An offset's ends: where the offsets meet, at a corner; at a
/// fold, where it leaves the face, but no farther than three radii beyond the line; else the line's own.
/// @throws base::InputError that names every line, by that of the file, that lies in no face: none whose
/// normal is the line's axis within half a degree, or whose plane and outline hold both of its ends to 0.05
/// mm.
SpaceJob layContour(const std::vector<ContourPoint>& contour, std::vector<SpaceFace> faces, double side,
                    double kerf_radius_mm, const std::string& name);

/// A drawing of lines beside the contour, in F. Entity k runs along the line `lines[k]`, from the way
/// `from_mm[k]` on.
struct FaceDrawing {
  std::shared_ptr<const dieline::Dieline> dieline;
  std::vector<std::size_t> lines;
  std::vector<double> from_mm;
};

/// What the kerf camera is to look for on a face.
struct FacePlan {
  FaceDrawing kerfs;  ///< The strict offsets: where the middle of the kerf should be.
  /// Beside those parts of the contour whose offset lies beyond a fold. No kerf need be there, but what the
  /// joint burns of the piece shows.
  FaceDrawing beyond;
};
FacePlan planFace(const SpaceJob& job, std::size_t face);

}  // namespace kerfbench::inspect
