// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/kerf_tiles.h"

namespace kerfbench::vision {

/// Half length of a caliper's window along the curve, where curve and ends allow.
inline constexpr double kWindowHalfMm = 0.1;
inline constexpr double kLongestArcRad = 0.35;  ///< Half of the longest arc of a caliper.

/// Window of the picture laid along a curve: `back` and `ahead` of a place along the tangent, `reach` to both
/// sides of it.
struct CaliperWindow {
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d tangent{Eigen::Vector2d::UnitX()};
  double curvature_per_mm{};
  double back_mm{0.1};
  double ahead_mm{0.1};
  double reach_mm{0.6};
};

/// One pixel of a window: signed distance from the curve along its left normal, and its light.
struct PixelAcross {
  float across_mm{};
  float along_mm{};
  float gray{};   ///< Gray as under even light: the uneven light is taken out.
  float share{};  ///< Share of the pixel between the ends of the window; (0, 1].
};

/// Brightness across a curve; sample i lies at first_mm + i * step_mm along the left normal.
///
/// Every pixel of the window counts at its own distance from the curve, spread by a quintic B-spline of
/// pixels (0.71 px RMS: about the blur of a lens, so noise is weighed best). That is smooth enough that the
/// grid of pixels hardly shows: a line along the grid would otherwise be read up to 0.03 px off, alike over a
/// long stretch, and no scatter would show it.
struct Profile {
  std::vector<float> gray;
  std::vector<float> weight;  ///< Pixels per sample, in pixels: 0 where all are hidden.
  double first_mm{};
  double step_mm{};
  double pixel_mm{};
  double noise_gray{};              ///< Noise of one pixel, on the board.
  std::vector<PixelAcross> pixels;  ///< Pixels of the profile.

  [[nodiscard]] std::size_t size() const { return gray.size(); }
  [[nodiscard]] bool seen(std::size_t i) const { return weight[i] >= kLeastWeight; }
  static constexpr float kLeastWeight = 0.6F;
};

/// Places on another kerf: pixels near them are left out of a profile.
struct OtherKerf {
  std::span<const Eigen::Vector2d> p_S_mm{};
  double within_mm{0.0};
};

/// Reads a window from the raw image, but for the pixels of another kerf.
void readProfile(const TileView& view, const CameraCalibration& calibration, const PlaneMotion& X_TS,
                 const CaliperWindow& window, const OtherKerf& other, Profile& profile);

/// Distance from a picture's edge that a caliper of this reach needs, with what rounding and a curve's bend
/// take.
double caliperBorderPx(double reach_mm, double pixel_mm);

/// The window of a station: as long as curvature and the ends of an open curve allow.
CaliperWindow windowOf(const Station& station, const EntityPlan& plan, double reach_mm);

}  // namespace kerfbench::vision
