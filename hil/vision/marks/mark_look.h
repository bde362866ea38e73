// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hil/vision/marks/mark_levels.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

// Parts of measureMark(): one look at a printed disc.

inline constexpr double kOuterRim = 1.4;  ///< Ring of board, in radii of a disc: all board out to here.

struct PixelBox {
  int left, top, right, bottom;  // Columns and rows, the last ones included.
};

std::optional<PixelBox> boxAround(const GrayImage& image, const Eigen::Vector2d& centre, double half_px);

MarkLevels roughLevels(const GrayImage& image, const PixelBox& box, double disc_share);

struct MarkLook {
  Eigen::Vector2d centroid;
  double area_px;
  MarkLevels levels;
  double stained_share;    ///< Share of the inner disc that is not ink.
  double darkened_share;   ///< Share of the outer ring that is darker than board.
  double board_share;      ///< Share of the outer ring that is board by the levels it was looked at with.
  double worst_sector_px;  ///< Farthest that a piece of the edge lies off the circle.
  double sigma_px;         ///< Standard deviation of the centroid, per axis.
};

/// Expected disc, and the stretch of its picture by the camera's tilt.
struct DiscPlace {
  Eigen::Vector2d centre;        ///< Centre in the picture, px.
  Eigen::Matrix2d mm_per_pixel;  ///< Map from the picture to the plane, at the centre.
  double radius_mm;
  double edge_half_px;  ///< Half the width of the disc's blurred edge.

  [[nodiscard]] double pitch_mm() const;  ///< Side of a square pixel of the same area, in the plane.
  [[nodiscard]] double radius_px() const { return radius_mm / pitch_mm(); }
};

/// Distances are measured in the plane, so that a tilted disc stays round. Without check_edge,
/// worst_sector_px and sigma_px are 0.
MarkLook lookAtMark(const GrayImage& image, const PixelBox& box, const DiscPlace& disc,
                    const MarkLevels& levels, bool check_edge);

/// Centroid of everything dark in the box, to come near enough to look.
std::optional<Eigen::Vector2d> darkCentroid(const GrayImage& image, const PixelBox& box,
                                            const Eigen::Vector2d& centre, double within_px,
                                            double threshold);

}  // namespace kerfbench::vision
