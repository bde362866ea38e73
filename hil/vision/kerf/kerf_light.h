// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "hil/vision/image/brightness_scan.h"

namespace kerfbench::vision {

/// Brightness of the back light over the picture, 1 in the middle: lamp and lens. A polynomial of second
/// degree, which holds a lens that darkens towards the corners and a lamp that falls off to one side.
class LightField {
 public:
  LightField() = default;  ///< Even light.
  /// Light field by the board in the pictures of one camera, whatever lies on it: cuts and print are left out
  /// as outliers, once the steps between neighbours have told the shape. Falls back to even light where too
  /// much of the board is covered.
  LightField(std::span<const Background* const> pictures, int width_px, int height_px);

  [[nodiscard]] double at(const Eigen::Vector2d& pixel) const;

 private:
  using Terms = Eigen::Matrix<double, 6, 1>;
  [[nodiscard]] Terms termsAt(const Eigen::Vector2d& pixel) const;

  Eigen::Vector2d middle_px_{Eigen::Vector2d::Zero()};
  double per_px_{0.0};
  Terms share_{Terms::Unit(0)};
};

}  // namespace kerfbench::vision
