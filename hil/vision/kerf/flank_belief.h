// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "hil/vision/kerf/kerf_flank.h"

namespace kerfbench::vision {

/// One way in which the flanks of kerfs may come to look as they do.
struct FlankView {
  LightGrowth growth{};
  double beam_radius_mm{};  ///< 1/e²; 0: a hard edge.
  double lens_px{};         ///< Standard deviation of the picture's blur.
  double open{1.0};         ///< Back light over what a query has it.
  double weight{1.0};       ///< How likely it is; all weights of a belief add up to 1.
};

/// What is known before kerfs are looked at.
struct FlankKnown {
  LightGrowth growth{};
  double law_sigma{}, begin_sigma{};
  double beam_radius_mm{};      ///< As the laser's data sheet has it.
  double radius_share_sigma{};  ///< Relative standard uncertainty of it.
  LensBlur blur;
  double open_sigma{0.0};  ///< Relative standard uncertainty of the back light.
};

/// The flanks of one entity as seen, on average.
struct SeenFlank {
  FlankQuery query;  ///< Half width, grey levels and pixel; the rest is not used.
  /// Half width at a quarter and at three quarters of the kerf's height.
  double low_half_mm{}, high_half_mm{};
  bool is_crease{};
};

struct FlankMoments {
  double likely{};
  double sigma{};  ///< RMS of the departures from it.
};

/// What is believed of light, beam and blur: the likeliest view, and views about it that have the
/// covariance of what is known (sigma points, Julier and Uhlmann 1997).
struct FlankBelief {
  FlankView likely;
  std::vector<FlankView> views;

  /// What the likeliest view makes of a quantity, and how far the others are from that.
  template <typename Quantity>
  [[nodiscard]] FlankMoments momentsOf(const Quantity& quantity) const {
    FlankMoments moments{quantity(likely), 0.0};
    for (const FlankView& view : views) {
      const double away = quantity(view) - moments.likely;
      moments.sigma += view.weight * away * away;
    }
    moments.sigma = std::sqrt(moments.sigma);
    return moments;
  }
};

/// Least squares over law, radius and blur, which all kerfs of a sheet have in common: how
/// steeply their flanks fall, against what is known before. Without flanks: what is known before.
/// Many flanks are computed on up to `threads` threads, with the same result.
FlankBelief beliefOf(const std::vector<SeenFlank>& flanks, const FlankKnown& known, int threads = 1);

}  // namespace kerfbench::vision
