// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/corner/corner_beam.h"
#include "hil/vision/corner/corner_light.h"
#include "hil/vision/corner/corner_raster.h"
#include "hil/vision/corner/corner_shape.h"
#include "hil/vision/kerf/light_law.h"

namespace kerfbench::vision {

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

/// Picture of a corner that a Gaussian beam cuts on a path, row by row, in gray: the beam's fluence
/// (CornerBeam), light by LightLaw of the depth that is left, then the blur (CornerRaster).
class CornerModel {
 public:
  /// Picture that is right in pixels that count alone. The nominal curves of `legs` are those of all shapes
  /// to come.
  CornerModel(const PixelGrid& grid, const std::vector<bool>& counts, const CornerShape& legs);

  void render(const CornerShape& shape, const CornerLight& light, std::vector<float>& gray);
  /// As render(), and prepares rateTowards() by the parts of this picture.
  void linearizeAt(const CornerShape& shape, const CornerLight& light, std::vector<float>& gray);
  /// Derivative of the picture of linearizeAt() by a parameter, of which a step of `step`, small enough for
  /// shape and light to be straight over it, makes this shape and light.
  void rateTowards(const CornerShape& shape, const CornerLight& light, double step,
                   std::vector<float>& gray_rate);

 private:
  /// Sets the samples to the light of `share_`.
  void shine(const LightTable& light);

  CornerRaster raster_;
  std::vector<std::size_t> index_;  ///< Places that light is asked for, in samples_.
  CornerFluence fluence_;           ///< At these places.
  std::vector<float> share_, share_rate_;
  std::vector<float> samples_;

  /// Picture of linearizeAt(), and how its samples grow with the fluence.
  struct Linear {
    CornerBeam beam;
    LightTable light;
    double blur_px{};
    std::vector<float> samples, gray, gray_per_share;
  };
  Linear at_;
};

}  // namespace kerfbench::vision
