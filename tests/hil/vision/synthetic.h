// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/camera/frame_source.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/tile_source.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/base/image.h"
#include "twin/base/print_layout.h"

namespace kerfbench::vision::test {

/// A camera 500 mm above the plane, tilted and with a barrel lens, of the given scale.
CameraCalibration tiltedCamera(int width_px, int height_px, double pitch_mm);

/// A picture in the making: gray levels before noise. Rendered from the places of things, by supersampling;
/// shares nothing with the code under test but the calibration.
class Canvas {
 public:
  Canvas(const CameraCalibration& calibration, double board_gray);

  /// Adds a printed disc, centre in the plane.
  void disc(const Eigen::Vector2d& p_mm, double diameter_mm, double gray);
  /// Adds everything for which `inside` is true, within the box of the plane.
  void shape(const Eigen::AlignedBox2d& box_mm, double gray,
             const std::function<bool(const Eigen::Vector2d&)>& inside, int samples = 5);
  /// Blurs all that was added so far, as a lens does.
  void blur(double sigma_px);
  /// Adds a glowing Gaussian spot that moved evenly from `from` to `to`; blur_px is the lens.
  void spot(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm, double sigma_mm, double height_gray,
            double blur_px);
  void pixel(int column, int row, double gray);

  /// Picture with shot noise for a full well of 1e4 electrons at 255, 0.8 gray of read noise, rounding,
  /// saturation.
  [[nodiscard]] GrayImage expose(std::uint64_t seed, std::uint64_t sequence) const;

 private:
  [[nodiscard]] double& at(int c, int r) {
    return gray_[static_cast<std::size_t>(r) * static_cast<std::size_t>(calibration_.width_px) +
                 static_cast<std::size_t>(c)];
  }
  const CameraCalibration& calibration_;
  std::vector<double> gray_;
};

/// Frames that are kept ready.
class ReadyFrames : public camera::FrameSource {
 public:
  explicit ReadyFrames(std::vector<Frame> frames) : frames_(std::move(frames)) {}
  std::vector<Frame> nextBatch(std::size_t max) override;

 private:
  std::vector<Frame> frames_;
  std::size_t next_{};
};

class ReadyTiles : public camera::TileSource {
 public:
  explicit ReadyTiles(std::vector<camera::KerfTile> tiles) : tiles_(std::move(tiles)) {}
  std::vector<camera::KerfTile> nextBatch(std::size_t max) override;

 private:
  std::vector<camera::KerfTile> tiles_;
  std::size_t next_{};
};

struct Statistics {
  double mean{};
  double sigma{};
};
Statistics statisticsOf(std::span<const double> values);

}  // namespace kerfbench::vision::test
