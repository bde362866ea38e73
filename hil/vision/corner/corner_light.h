// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace kerfbench::vision
