// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf/kerf_blur.h"
#include "hil/vision/kerf/light_law.h"

namespace kerfbench::vision {

/// Look of a kerf in the picture.
struct KerfLook {
  double half_width_mm{};  ///< Half the width at half height, as seen.
  double brightness{1.0};  ///< Brightness of its middle.
  double board_gray{};
  double open_gray{};
  double beam_radius_mm{};  ///< 1/e²; 0: a round tool as wide as the kerf.
  double pixel_mm{};
  double lens_px{0.7};  ///< Standard deviation of the picture's blur.
  LightGrowth growth{};
};

/// Outline of a kerf beyond its end: its reach beyond where the beam stopped.
///
/// A Gaussian beam of radius w lays along a straight path, s0 being the share of the cutting fluence in the
/// middle of it, s0 exp(-2 n²/w²) erfc(sqrt(2) a/w) / 2 at n beside and a beyond its end. Light by LightLaw,
/// as in FlankModel; then the blur of lens and spline. s0 is what makes the kerf as wide as it is seen.
class KerfOutline {
 public:
  explicit KerfOutline(const KerfLook& look);

  /// Mean reach along the kerf beyond its end, over a strip of half width `strip_mm`.
  [[nodiscard]] double reachMm(double strip_mm) const;

 private:
  /// Brightness of the middle of a straight kerf, by the share of the fluence there.
  class Middle {
   public:
    explicit Middle(const KerfLook& look);
    [[nodiscard]] double grayAt(double peak, const KerfOutline& outline) const;

   private:
    std::vector<double> weights_, beam_;
    double weight_{};
  };

  /// The share in the middle of the path that makes the kerf look as it does.
  [[nodiscard]] double fittedPeak() const;
  [[nodiscard]] int samplesOfLook() const;
  [[nodiscard]] double grayAt(double share) const;
  /// Half width of a profile that falls outwards, blurred: where it crosses half way.
  [[nodiscard]] double fallMm(const std::vector<double>& gray, double first_mm) const;

  KerfLook look_;
  LightLaw law_;
  double step_mm_;
  BlurKernel kernel_;
  double peak_share_{1.0};
};

}  // namespace kerfbench::vision
