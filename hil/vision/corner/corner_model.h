// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/corner/corner_shape.h"
#include "hil/vision/kerf/light_law.h"

namespace kerfbench::vision {

/// Light of a kerf's picture, beyond its shape.
struct CornerLight {
  double peak_in{1.5};         ///< Peak fluence of the leg in, over that which cuts through.
  double peak_out{1.5};        ///< Peak fluence of the leg out, over that which cuts through.
  double beam_radius_mm{0.1};  ///< 1/e².
  double board_gray{};
  double open_gray{};
  LightGrowth growth{};
  double blur_px{0.7};     ///< RMS of the lens, the pixel's own area included.
  double scorch_in_mm{};   ///< Shift of the picture of the leg in to its left, by scorch on one side.
  double scorch_out_mm{};  ///< Shift of the picture of the leg out to its left, by scorch on one side.
};

/// Rectangle of pixels and their places: p_mm = first_mm + column * per_column_mm + row * per_row_mm, from
/// the nominal corner, in the sheet's directions.
struct PixelGrid {
  int columns{};
  int rows{};
  Eigen::Vector2d first_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d per_column_mm{Eigen::Vector2d::UnitX()};
  Eigen::Vector2d per_row_mm{Eigen::Vector2d::UnitY()};

  [[nodiscard]] Eigen::Vector2d at(double column, double row) const {
    return first_mm + column * per_column_mm + row * per_row_mm;
  }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

/// Picture of a corner that a Gaussian beam cuts on a path, row by row, in gray.
///
/// Fluence as KerfOutline has it: along a leg s0 exp(-2 n²/w²) erfc(sqrt(2) a/w) / 2 at n beside it and a
/// beyond its end, and s0 sqrt(2/pi)/w exp(-2 d²/w²) per length of an arc at a distance d. Light by
/// LightLaw of the depth that is left; then the blur. Two samples per pixel, each way.
class CornerModel {
 public:
  /// Picture that is right in pixels that count alone. The nominal curves of `legs` are those of all shapes
  /// to come.
  CornerModel(const PixelGrid& grid, const std::vector<bool>& counts, const CornerShape& legs);

  void render(CornerShape shape, const CornerLight& light, std::vector<float>& gray);

 private:
  /// The places that light is asked for, and what shines there.
  struct Samples {
    std::vector<std::size_t> index;  ///< Index into sharp_.
    std::vector<float> x_mm, y_mm, in_along_mm, in_beside_mm, out_along_mm, out_beside_mm, share;
  };
  void blur(double blur_px);

  int columns_, rows_;  ///< Columns and rows of samples.
  int pixel_columns_, pixel_rows_;
  Samples samples_;
  std::vector<float> sharp_, across_;
};

}  // namespace kerfbench::vision
