// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "hil/camera/tile_source.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "twin/base/print_layout.h"
#include "twin/camera/camera.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::vision::test {

constexpr double kBeamRadiusMm = 0.105;

/// A camera of 1100 x 800 pixels times scale, askew and with a lens; 40 um to the pixel by default.
twin::CameraDescription kerfCamera(double pitch_mm = 0.04, double scale = 1.0);
CameraCalibration calibrationOf(const twin::CameraDescription& camera);

/// A sheet that the model cuts and photographs, with everything known; thin unless the board says otherwise.
struct TwinCut {
  twin::BoardDescription board;
  twin::CameraDescription camera = kerfCamera();
  PrintLayout print;
  dieline::Dieline dieline;
  std::map<int, double> offset_mm;  ///< Offset of each entity, along the left normal; 0 by default.
  double fluence_share{1.5};  ///< Fluence in the middle of a line, relative to the one that cuts through.
  std::map<int, double> share_of;  ///< Fluence of single entities, in the same unit.
  KerfScanOptions options;
  std::uint64_t seed{1};
  /// Cuts further things onto the sheet.
  std::function<void(twin::Sheet&)> also;

  TwinCut();
  int add(dieline::Curve curve, dieline::Process process = dieline::Process::kCut);
  /// Burns a straight line with the model's beam: energy for the share of the cutting fluence.
  void burn(twin::Sheet& sheet, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
            double share) const;
  void burn(twin::Sheet& sheet, const dieline::Curve& curve, double offset, double share) const;

  [[nodiscard]] twin::Sheet sheet() const;
  [[nodiscard]] std::vector<camera::KerfTile> tiles() const;
  [[nodiscard]] KerfScan scan() const;
  [[nodiscard]] KerfScan scan(std::vector<camera::KerfTile> tiles) const;
  /// Place of the unit on the table.
  [[nodiscard]] Eigen::Isometry2d lay() const;
  /// True offset of a caliper in the scan's own place of the unit: the remainder is the caliper's error
  /// alone. The kerf of an arc lies inside of the beam's path by w² / (8 r): a Gaussian beam of 1/e² radius w
  /// (standard deviation w / 2) along a circle of radius r leaves its ridge there.
  [[nodiscard]] double truth(const KerfScan& scan, const Caliper& caliper, const dieline::Curve& curve,
                             double offset) const;
};

struct Honesty {
  std::size_t count{};
  double bias_mm{};
  double sigma_mm{};   ///< Standard deviation of the error.
  double stated_mm{};  ///< Quadratic mean of the calipers' stated errors.
  double z{};          ///< RMS of error over stated uncertainty.
  double width_z{};    ///< Standard deviation of width over its stated uncertainty, about each entity's mean.
};
/// Collects errors of all calipers that were found and lie near no joint.
class Errors {
 public:
  void add(const TwinCut& cut, const KerfScan& scan);
  [[nodiscard]] Honesty honesty() const;

 private:
  std::vector<double> errors_mm_, stated_mm_, width_z_;
};

const EntityKerf& entityOf(const KerfScan& scan, int id, int unit = 0);

}  // namespace kerfbench::vision::test
