// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/image/brightness_scan.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/marks/mark_levels.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Printed disc that was found, darker than the board around it.
struct FoundMark {
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};  ///< Centre of the disc in the camera's plane.
  /// Centroid of the picture; not quite the picture of the centre.
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  double diameter_mm{};  ///< Diameter that was looked for.
  MarkLevels levels;
  /// Standard uncertainty of p_mm per axis, from how the edge of this disc scatters about a circle: noise,
  /// grain and a rough print, but not the map.
  double sigma_mm{};
};

/// Measures the disc near a point of the plane, no farther away than search_mm: gray-weighted centroid of the
/// edge, mapped through the calibration so that perspective shifts nothing. nullopt if there is no whole,
/// undisturbed disc of about this diameter.
///
/// `known`: the levels of this mark in pictures before, where near_mm is predicted from one of them. A
/// disc that lies there within a pixel and has these levels is measured without being searched for, as well
/// as with levels of its own picture. Any other is searched for as if nothing were known.
std::optional<FoundMark> measureMark(const GrayImage& image, const CameraCalibration& calibration,
                                     const Eigen::Vector2d& near_mm, double diameter_mm, double search_mm,
                                     const std::optional<MarkLevels>& known = std::nullopt);

/// All discs of about the given diameters in the picture, in order of row.
std::vector<FoundMark> findMarks(const GrayImage& image, const CameraCalibration& calibration,
                                 const Background& background, std::span<const double> diameters_mm);

/// Least distance of a disc's centre from the edge of the image, px.
double markBorderPx(double radius_px);

}  // namespace kerfbench::vision
