// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_pictures.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/base/parallel.h"
#include "hil/camera/kerf_tile.h"
#include "hil/vision/kerf/kerf_faults.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr std::size_t kTilesPerBatch = 8;
constexpr double kNoiseSigmas = 3.0;  // Least contrast in sigmas of one pixel: nine sigmas of a mean of nine
                                      // where no grain correlates them.

std::vector<double> diametersOf(const PrintLayout& print) {
  std::vector<double> diameters_mm;
  for (const RegistrationMark& mark : print.marks) diameters_mm.push_back(mark.diameter_mm);
  std::sort(diameters_mm.begin(), diameters_mm.end());
  diameters_mm.erase(std::unique(diameters_mm.begin(), diameters_mm.end()), diameters_mm.end());
  return diameters_mm;
}

}  // namespace

std::vector<camera::KerfTile> UnitTiles::next() {
  std::vector<camera::KerfTile> unit;
  for (;;) {
    if (pending_.empty()) {
      pending_ = source_.nextBatch(kTilesPerBatch);
      if (pending_.empty()) return unit;
      for (const camera::KerfTile& tile : pending_) {
        if (tile.image.width != calibration_.width_px || tile.image.height != calibration_.height_px) {
          throw std::invalid_argument("a kerf tile of unit " + std::to_string(tile.unit) +
                                      " has not the size that the camera is calibrated for");
        }
      }
      std::reverse(pending_.begin(), pending_.end());
    }
    if (!unit.empty() && pending_.back().unit != unit.front().unit) return unit;
    unit.push_back(std::move(pending_.back()));
    pending_.pop_back();
  }
}

UnitPictures viewUnit(std::vector<camera::KerfTile> tiles, int unit, const PrintLayout& print,
                      const CameraCalibration& calibration, const KerfScanOptions& options,
                      std::vector<std::string>& problems) {
  const std::vector<double> diameters_mm = diametersOf(print);
  UnitPictures pictures;
  pictures.views.resize(tiles.size());
  base::forEachIndex(tiles.size(), options.threads, [&](std::size_t i) {
    pictures.views[i] = viewTile(std::move(tiles[i]), calibration, diameters_mm);
  });
  pictures.blur = blurOf(pictures.views, calibration);
  tellTileFaults(pictures.views, unit, pictures.blur, options.widest_blur_px, problems);
  shareLight(pictures.views);
  return pictures;
}

GrayImage brightPlaces(const TileView& view, double open_gray, double least_share) {
  constexpr int kCell = Background::kCellPx;
  const GrayImage& image = view.tile.image;
  // Only read: OpenCV has no view of constant memory.
  const cv::Mat picture(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat smooth;
  cv::boxFilter(picture, smooth, CV_8U, cv::Size(3, 3), cv::Point(-1, -1), true, cv::BORDER_REPLICATE);
  GrayImage places(image.width, image.height);
  cv::Mat mask(image.height, image.width, CV_8U, places.pixels.data());
  for (int top = 0; top < picture.rows; top += kCell) {
    for (int left = 0; left < picture.cols; left += kCell) {
      const cv::Rect cell(left, top, std::min(kCell, picture.cols - left),
                          std::min(kCell, picture.rows - top));
      const double board = view.background->at(left, top);
      const Eigen::Vector2d middle(left + 0.5 * cell.width, top + 0.5 * cell.height);
      const double open = open_gray * view.light.at(middle);
      const double above = std::max(kNoiseSigmas * view.noise_gray, least_share * (open - board));
      cv::Mat part = mask(cell);
      cv::threshold(smooth(cell), part, board + above, 255, cv::THRESH_BINARY);
    }
  }
  return places;
}

}  // namespace kerfbench::vision
