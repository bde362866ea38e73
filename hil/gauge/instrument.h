// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "hil/camera/tile_source.h"
#include "hil/gauge/artefact.h"
#include "hil/gauge/world.h"
#include "hil/inspect/inspect.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "twin/description/description.h"
#include "twin/description/imperfections.h"

namespace kerfbench::gauge {

/// Instrument to be gauged: a machine's two cameras with their calibrations, and the judge behind them.
struct GaugeSetup {
  twin::MachineDescription machine;  ///< Machine as described.
  twin::ImperfectionSpread spread;
  vision::CameraCalibration kerf_calibration, spot_calibration;
  twin::BoardDescription board;
  inspect::Tolerances limits;
  double radius_sigma{0.05};  ///< Relative, and the next: what the bench is told of its uncertainty.
  double print_sigma_mm{};
  double scale_sigma{};          ///< Relative.
  double open_gray_sigma{0.02};  ///< Relative.
  bool mismatch{};  ///< Cases are cut and seen in worlds that are not the bench's own; see otherWorld().
};

/// A part of a camera's sensor, read out alone: the same lens and mount, fewer pixels. An artefact is smaller
/// than the field, and gauge takes thousands of pictures.
struct SensorWindow {
  int x0_px{}, y0_px{}, width_px{}, height_px{};
};
twin::CameraDescription windowOf(const twin::CameraDescription& camera, const SensorWindow& window);
vision::CameraCalibration windowOf(const vision::CameraCalibration& calibration, const SensorWindow& window);

/// Pose of an artefact under the kerf camera.
struct Placement {
  SensorWindow window;
  Eigen::Vector2d p_TV_mm{Eigen::Vector2d::Zero()};
  Eigen::Isometry2d X_TS{Eigen::Isometry2d::Identity()};
};

/// Measurement of one picture of an artefact by the bench.
struct KerfMeasurement {
  vision::KerfScan scan;
  inspect::InspectionResult result;
  inspect::Verdict verdict{
      inspect::Verdict::kInvalid};  ///< Verdict of the checks that rest on the kerf alone.
};

/// The kerf camera and the judge, as in a run: same calibration file, same options, same code.
class KerfInstrument {
 public:
  /// `setup` must outlive this. @throws std::invalid_argument if the artefact does not fit into the field.
  KerfInstrument(const GaugeSetup& setup, const Artefact& artefact);

  /// Anywhere in the field, shifted by up to 1 mm and turned by up to 0.3 degrees, as in a run.
  [[nodiscard]] Placement draw(std::uint64_t seed) const;
  /// `board_seed`: which piece of board; `noise_seed`: of the sensor's noise.
  [[nodiscard]] camera::KerfTile picture(const twin::Sheet& sheet, const World& world,
                                         const Placement& placement, std::uint64_t board_seed,
                                         std::uint64_t noise_seed) const;
  /// As in a run: of the world the bench is told the board's thickness alone.
  [[nodiscard]] KerfMeasurement measure(camera::KerfTile tile, const Placement& placement,
                                        double thickness_mm) const;

 private:
  const GaugeSetup& setup_;
  const Artefact& artefact_;
  int width_px_{}, height_px_{};
};

}  // namespace kerfbench::gauge
