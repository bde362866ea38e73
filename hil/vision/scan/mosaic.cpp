// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/scan/mosaic.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "hil/base/parallel.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr int kLevelStep = 8;  ///< 256 levels become 32: noise of the board makes a picture large.

std::uint8_t brightestAround(const GrayImage& image, const Eigen::Vector2d& pixel, double half_px) {
  const int left = std::max(static_cast<int>(std::ceil(pixel.x() - half_px)), 0);
  const int right = std::min(static_cast<int>(std::floor(pixel.x() + half_px)), image.width - 1);
  const int top = std::max(static_cast<int>(std::ceil(pixel.y() - half_px)), 0);
  const int bottom = std::min(static_cast<int>(std::floor(pixel.y() + half_px)), image.height - 1);
  std::uint8_t brightest = 0;
  for (int row = top; row <= bottom; ++row)
    for (int column = left; column <= right; ++column) brightest = std::max(brightest, image.at(column, row));
  return brightest;
}

}  // namespace

KerfMosaic mosaicOf(const TileIndex& tiles, const CameraCalibration& calibration, const MosaicView& view,
                    int threads) {
  const Eigen::Vector2d sizes_mm = view.box_S_mm.sizes();
  const double pitch_mm = sizes_mm.maxCoeff() / view.longest_px;
  const auto pixels = [&](double mm) { return std::max(1, static_cast<int>(std::lround(mm / pitch_mm))); };
  const auto image = std::make_shared<GrayImage>(pixels(sizes_mm.x()), pixels(sizes_mm.y()));
  base::forEachIndex(static_cast<std::size_t>(image->height), threads, [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < image->width; ++column) {
      // Rows run down from the largest y.
      const Eigen::Vector2d p_S_mm(view.box_S_mm.min().x() + (column + 0.5) * pitch_mm,
                                   view.box_S_mm.max().y() - (row + 0.5) * pitch_mm);
      const Eigen::Vector2d p_T_mm = view.X_TS * p_S_mm;
      const TileView* tile = tiles.best(p_T_mm, 0.0);
      if (tile == nullptr) continue;
      const LocalPixelMap map = calibration.localMap(p_T_mm - tile->tile.p_TV_mm);
      const int level = brightestAround(tile->tile.image, map.pixel, 0.5 * pitch_mm * map.pxPerMm());
      image->at(column, row) = static_cast<std::uint8_t>(level / kLevelStep * kLevelStep);
    }
  });
  return {view.unit, image, view.box_S_mm};
}

double badnessOf(const KerfScan& scan, int unit) {
  double missing = 0.0;
  double largest_mm = 0.0;
  for (const EntityKerf& kerf : scan.entities) {
    if (kerf.unit != unit) continue;
    for (const Caliper& c : kerf.calipers) {
      if (c.near_joint) continue;
      if (!c.found) missing += 1.0;
      if (c.found) largest_mm = std::max(largest_mm, std::abs(c.offset_mm));
    }
  }
  return missing + largest_mm;
}

}  // namespace kerfbench::vision
