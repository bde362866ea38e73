// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "twin/base/image.h"

namespace kerfbench::camera {

/// A back-lit picture of a part of the finished sheet on the inspection table. X_TV shifts the camera's plane
/// V to the table T, as the table's own scales read it; the sheet's place on the table comes from its printed
/// marks.
struct KerfTile {
  GrayImage image;
  Eigen::Vector2d p_TV_mm{Eigen::Vector2d::Zero()};
  int unit{};      ///< Unit on the table; every unit is laid down and looked at alone.
  bool is_last{};  ///< No other tile of this unit follows; false: not told.
};

}  // namespace kerfbench::camera
