// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/camera/kerf_tile.h"
#include "hil/vision/image/brightness_scan.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_light.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "hil/vision/marks/constellation.h"
#include "hil/vision/marks/mark_finder.h"
#include "twin/base/print_layout.h"

namespace kerfbench::vision {

/// A tile with what is needed to measure in it.
struct TileView {
  camera::KerfTile tile;
  Eigen::Vector2d centre_T_mm{Eigen::Vector2d::Zero()};  ///< Place that the middle of the image sees.
  double half_diagonal_mm{};
  std::optional<Background> background;
  double noise_gray{};
  std::vector<FoundMark> marks;  ///< Marks by their places in the camera's plane V.
  LightField light;              ///< Back light over the field; see shareLight().
};

/// Looks at board and marks.
TileView viewTile(camera::KerfTile tile, const CameraCalibration& calibration,
                  const std::vector<double>& diameters_mm);

/// Gives all tiles the light that they were taken in: the camera carries its light with it.
void shareLight(std::vector<TileView>& tiles);

/// The tiles of one unit, to be asked for the one that sees a point best.
class TileIndex {
 public:
  TileIndex(const std::vector<TileView>& tiles, const CameraCalibration& calibration);

  /// The tile that sees the point at least border_px inside its edge, with its middle nearest; nullptr if
  /// there is none.
  [[nodiscard]] const TileView* best(const Eigen::Vector2d& p_T_mm, double border_px) const;
  /// All tiles that see the point so, the best one first.
  [[nodiscard]] std::vector<const TileView*> seeing(const Eigen::Vector2d& p_T_mm, double border_px) const;

 private:
  /// Tiles of the cell that a point lies in.
  [[nodiscard]] std::span<const std::uint32_t> near(const Eigen::Vector2d& p_T_mm) const;

  const std::vector<TileView>& tiles_;
  const CameraCalibration& calibration_;
  Eigen::AlignedBox2d box_T_mm_;
  double cell_mm_{1.0};
  int columns_{};
  int rows_{};
  std::vector<std::vector<std::uint32_t>> cells_;  ///< Tiles that may see a point of the cell.
};

/// A mark of the print that was seen.
struct SeenMark {
  std::size_t mark{};  ///< Index in PrintLayout::marks.
  MarkPair pair;
};

/// Pose of one unit on the table.
struct UnitPlace {
  PlaneMotion X_TS;
  double residual_mm{};  ///< RMS of the marks; NaN with fewer than two.
  int marks{};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< Covariance as UnitPose's.
  /// All marks of the print that were seen, also those that the pose leaves out because they lie elsewhere.
  std::vector<SeenMark> seen{};
};

/// The unit that is looked for.
struct WantedUnit {
  int unit{};
  const PrintLayout* print{};
  double
      mark_sigma_mm{};  ///< Uncertainty of where a mark is printed and where the table says it is, per axis.
};

/// Pose by the marks in the tiles, wherever on the table the unit lies. Faults are added to `problems`.
/// nullopt if the marks do not suffice.
std::optional<UnitPlace> placeUnit(const std::vector<TileView>& tiles, const TileIndex& index,
                                   const WantedUnit& wanted, const CameraCalibration& calibration,
                                   std::vector<std::string>& problems);

}  // namespace kerfbench::vision
