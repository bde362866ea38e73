// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_tiles.h"

namespace kerfbench::calibrate {

/// A bright blob of a picture, as the rod with its second moments.
struct Stroke {
  Eigen::Vector2d p_T_mm{Eigen::Vector2d::Zero()};  ///< Middle of the stroke on the table.
  /// Vector from the middle to one end, the kerf's rounding included.
  Eigen::Vector2d half_mm{Eigen::Vector2d::Zero()};
  double width_mm{};
  double from_middle_mm{};  ///< Distance from the middle of its picture: of a stroke seen in two, the one
                            ///< nearer to the middle is kept.
};

/// All blobs that lie whole in the picture.
std::vector<Stroke> findStrokes(const vision::TileView& view, const vision::CameraCalibration& calibration,
                                double open_gray);

/// Strokes of all pictures, each once.
std::vector<Stroke> uniqueStrokes(const std::vector<Stroke>& strokes);

/// Whether a stroke is an arm of a mark of this size, scaled by no more than a fifth.
bool isArm(const Stroke& stroke, double size_mm);

/// Four arms that point at one place.
struct Cross {
  Eigen::Vector2d p_T_mm{Eigen::Vector2d::Zero()};
  /// Arms in turn, counter-clockwise as seen; the first is any of them. From middle of an arm to that of the
  /// opposite one its line is straight.
  std::array<Stroke, 4> arms;
  /// Axes of a mark from its centre: columns along the first and the second arm, mm for each unit of M.
  Eigen::Matrix2d axes_mm{Eigen::Matrix2d::Identity()};
};

/// Arms put together.
struct Crosses {
  std::vector<Cross> whole;
  std::vector<Eigen::Vector2d> broken_T_mm;  ///< Places that two opposite arms point at, and no others.
  std::vector<Stroke> single;                ///< Arms that belong to neither.
};
Crosses assembleCrosses(const std::vector<Stroke>& arms, double size_mm);

}  // namespace kerfbench::calibrate
