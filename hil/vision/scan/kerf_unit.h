// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "hil/vision/image/lens_blur.h"
#include "hil/vision/kerf/flank_belief.h"
#include "hil/vision/kerf/kerf_caliper.h"
#include "hil/vision/kerf/kerf_noise.h"
#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/kerf_tiles.h"
#include "hil/vision/scan/sight_depth.h"

namespace kerfbench::vision {

struct JointScene;

/// The pictures of a sheet, and where one unit lies on it.
struct PlacedUnit {
  const std::vector<TileView>& tiles;
  const TileIndex& index;
  int unit;
  const PlaneMotion& X_TS;
  const LensBlur& blur;
  const SightDepths& depths;
  /// What an error of scale leaves in place; see KerfScanOptions::scale_sigma.
  Eigen::Vector2d marks_centre_S_mm{Eigen::Vector2d::Zero()};
};

/// Measures everything about one unit whose place is known.
class UnitScan {
 public:
  UnitScan(const CameraCalibration& calibration, const KerfPlan& plan, const KerfScanOptions& options,
           const PlacedUnit& place)
      : calibration_(calibration),
        depths_(place.depths),
        seen_{calibration.lowered(place.depths[0].mm), calibration.lowered(place.depths[1].mm)},
        plan_(plan),
        options_(options),
        tiles_(place.tiles),
        index_(place.index),
        unit_(place.unit),
        X_TS_(place.X_TS),
        marks_centre_S_mm_(place.marks_centre_S_mm),
        blur_(place.blur) {}

  /// Calipers with their uncertainties, corners, ends and the unit's worst patches.
  void cuts(KerfScan& scan) const;
  void strays(KerfScan& scan) const;

 private:
  /// A caliper's window on the grid of pixels, px: a step along it, and one as long across.
  struct WindowOnPixels {
    Eigen::Vector2d along_px{Eigen::Vector2d::Zero()};
    Eigen::Vector2d across_px{Eigen::Vector2d::Zero()};
    /// Error that the grid leaves in the offset of a kerf that lies askew in the window.
    [[nodiscard]] double gridNoise_mm(double slope, double pixel_mm) const {
      return gridNoisePx(along_px + slope * across_px) * pixel_mm;
    }
  };
  struct Scratch;
  /// The camera over the plane in which it sees a kerf's middle.
  [[nodiscard]] const CameraCalibration& cameraFor(const EntityPlan& plan) const {
    return seen_.at(static_cast<std::size_t>(formOf(plan.process)));
  }
  [[nodiscard]] const SightDepth& depthOf(const EntityPlan& plan) const {
    return depths_.at(static_cast<std::size_t>(formOf(plan.process)));
  }
  /// Uncertainty of a place by that of the depth at which an entity is seen, along each axis of S.
  [[nodiscard]] Eigen::Vector2d depthSigma_mm(const EntityPlan& plan, const Eigen::Vector2d& p_S_mm) const;
  /// What one standard deviation of the scale moves a place by, in S: away from the unit's marks.
  [[nodiscard]] Eigen::Vector2d scaleSigma_mm(const Eigen::Vector2d& p_S_mm) const;
  /// How much of a slit's length in a direction of S its walls hide, seen aslant.
  struct Hidden {
    double likely_mm{}, sigma_mm{};
  };
  [[nodiscard]] Hidden hiddenBy(const Eigen::Vector2d& p_V_mm, const Eigen::Vector2d& direction_S) const;
  /// What walls hide of the widths, put back.
  void widen(const EntityPlan& plan, EntityKerf& kerf) const;
  /// What walls hide of a slit before its end, put back.
  void lengthen(const Eigen::Vector2d& p_S_mm, const Eigen::Vector2d& outward, LineEnd& end) const;
  [[nodiscard]] JointScene sceneOf(const EntityPlan& plan, const std::vector<EntityKerf>& kerfs,
                                   const FlankBelief& belief) const;
  /// One entity while it is measured.
  struct Measured {
    CutNoise noise;
    std::vector<KerfReading> readings;
    std::vector<WindowOnPixels> windows;
    std::size_t unseen{};  ///< Calipers outside of the tiles.
  };
  void measure(const EntityPlan& plan, EntityKerf& kerf, Measured& out) const;
  void correct(const EntityPlan& plan, const FlankBelief& belief, EntityKerf& kerf, Measured& out) const;
  /// What all kerfs that are cut through, as seen, tell of light, beam and blur; and creases, if wanted.
  [[nodiscard]] FlankBelief beliefOf(const std::vector<EntityKerf>& kerfs,
                                     const std::vector<Measured>& measured, bool by_creases) const;
  void caliper(const EntityPlan& plan, const Station& station, const TileView& view, Scratch& scratch,
               Caliper& out, KerfReading& reading) const;
  [[nodiscard]] WindowOnPixels windowOnPixels(const EntityPlan& plan, const Station& station,
                                              const TileView* view) const;
  void joints(const std::vector<EntityKerf>& kerfs, const FlankBelief& belief, KerfScan& scan) const;
  [[nodiscard]] LineEnd freeEnd(const JointScene& scene, const EntityEnd& end) const;
  void patches(const std::vector<EntityKerf>& kerfs, KerfScan& scan) const;

  const CameraCalibration& calibration_;  ///< Over the plane of the marks.
  SightDepths depths_;
  std::array<CameraCalibration, kKerfForms> seen_;
  const KerfPlan& plan_;
  const KerfScanOptions& options_;
  const std::vector<TileView>& tiles_;
  const TileIndex& index_;
  int unit_;
  PlaneMotion X_TS_;
  Eigen::Vector2d marks_centre_S_mm_;
  LensBlur blur_;
};

}  // namespace kerfbench::vision
