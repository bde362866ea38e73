// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/image/lens_blur.h"
#include "hil/vision/kerf/kerf_caliper.h"
#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/light_law.h"

namespace kerfbench::vision {

/// Profile of a kerf, by which the effect of scorch on its two flanks is computed.
struct FlankQuery {
  double half_width_mm{};  ///< Half the width at half height.
  double top_gray{};       ///< Grey in the middle.
  double board_gray{};
  double open_gray{};
  double beam_radius_mm{};  ///< 1/e²; 0: a hard edge.
  double pixel_mm{};
  double lens_px{};  ///< Standard deviation of the picture's blur.
  LightGrowth growth{};
};

/// How a kerf that is as wide as seen falls off.
struct FlankFall {
  double light_mm{};           ///< Half width of the light that comes through, without blur.
  double low_mm{}, high_mm{};  ///< Half widths at a quarter and three quarters of the height, blurred.
  /// At half of the height, blurred: as seen for an open kerf, whose energy is unknown. How deep a shallow
  /// one is its light shows, and how wide it is then follows.
  double half_mm{};
};
FlankFall fallOf(const FlankQuery& seen);

/// Whether a kerf is as bright as one that is cut through. How much energy that took it does not show; of
/// another one the light tells the depth.
bool isOpen(const FlankQuery& seen);

/// Model of a kerf's flanks under scorch, which takes a share k of the light of all remaining board, more on
/// one side than on the other: the two flanks differ from each other's mirror image, and their middle moves.
/// The shift follows from the scorch seen on whole board next to the kerf.
///
/// The profile of the model: a Gaussian beam of peak s0 burns the share s = s0 exp(-2 y²/w²) of what cuts;
/// light by LightLaw; blurred by lens and spline. One difference of k between the
/// sides stands for all distances. Of scorch that moves the flanks by up to 5 um, 1 um is left.
class FlankModel {
 public:
  explicit FlankModel(const FlankQuery& query);

  /// Shift of the middle of the flanks towards the left normal, from KerfReading::odd_gray.
  [[nodiscard]] double shiftMm(double odd_gray) const { return gain_mm_ * odd_gray; }
  /// Widening of the kerf by lens and spline, over the light that comes through.
  [[nodiscard]] double widening_mm() const { return widening_mm_; }

 private:
  double gain_mm_{};      ///< Per gray; 0 where the model does not hold.
  double widening_mm_{};  ///< 0 where the model does not hold.
};

struct FlankBelief;
struct SeenFlank;

/// Parts of the look of a kerf's flank.
struct FlankOptics {
  const KerfScanOptions& options;  ///< Gray of open board, radius of the beam.
  double pixel_mm;                 ///< Side of a pixel on the sheet.
  const LensBlur& blur;
};

/// Takes out of all calipers of an entity what scorch, print or the bend of a curve does to their centres,
/// and what blur does to their widths. The scorch is taken as the mean over 1 mm along the curve each way.
/// `model_mm` gets what remains uncertain of that, per station.
void correctFlankBias(const EntityPlan& plan, const std::vector<KerfReading>& readings,
                      const FlankOptics& optics, const FlankBelief& belief, EntityKerf& kerf,
                      std::vector<double>& model_mm);

/// The mean flank of an entity; its half width is 0 where no reading shows one.
SeenFlank meanFlank(const EntityPlan& plan, const std::vector<KerfReading>& readings,
                    const FlankOptics& optics, const EntityKerf& kerf);

/// Takes out what the length of the window and the lens do where the kerf itself bends: a caliper reads the
/// mean over its window, which of a kerf of curvature k lies k L²/24 (window of length L) inside, and the
/// lens, of blur sigma, draws both flanks in by k sigma²/2. The kerf's bend beyond that of the dieline is its
/// second difference over readings 0.3 mm apart; where one of those is missing nothing is taken out.
void correctCurvatureBias(const EntityPlan& plan, double lens_mm, EntityKerf& kerf);

}  // namespace kerfbench::vision
