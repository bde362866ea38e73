// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/spot/sheet_tracker.h"
#include "twin/base/image.h"

namespace kerfbench::vision {

/// Window around the spot: the box that it should be in, and as far around as a calibration, a late mirror
/// and the board that the fit wants around it may take. Empty if that lies outside of the picture.
PixelWindow spotWindow(const CameraCalibration& calibration, const Eigen::AlignedBox2d& box_W_mm);

/// A window for each place where a mark is to be measured.
std::vector<PixelWindow> markWindows(const CameraCalibration& calibration,
                                     std::span<const SheetTracker::MarkPlace> places);

/// Bands across the picture, in which all marks pass that lie as far across the belt as these: what a search
/// for marks needs. Bands that meet are one.
std::vector<PixelWindow> markBands(const CameraCalibration& calibration,
                                   std::span<const SheetTracker::MarkPlace> places);

}  // namespace kerfbench::vision
