// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_pictures.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/base/parallel.h"
#include "hil/camera/kerf_tile.h"
#include "hil/vision/kerf/kerf_faults.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr std::size_t kTilesPerBatch = 8;
constexpr double kNoiseSigmas = 3.0;  // Least contrast in sigmas of one pixel: nine sigmas of a mean of nine
                                      // where no grain correlates them.
constexpr double kGrainSigmas = 5.0;  // Least contrast in sigmas of the board's own grain.
constexpr int kBoxPx = 3;             // Side of the square whose mean is taken.
constexpr int kBox = kBoxPx * kBoxPx;
constexpr int kSampleStride = 4;  // Pixels between samples of the grain.

std::vector<double> diametersOf(const PrintLayout& print) {
  std::vector<double> diameters_mm;
  for (const RegistrationMark& mark : print.marks) diameters_mm.push_back(mark.diameter_mm);
  std::sort(diameters_mm.begin(), diameters_mm.end());
  diameters_mm.erase(std::unique(diameters_mm.begin(), diameters_mm.end()), diameters_mm.end());
  return diameters_mm;
}

/// 255 where a sum is above a level, otherwise 0; cv::compare takes four times as long.
void markAbove(const cv::Mat& sums, double level, cv::Mat mask) {
  const auto most = static_cast<int>(std::numeric_limits<std::uint16_t>::max());
  const auto limit = static_cast<std::uint16_t>(std::clamp(level, 0.0, static_cast<double>(most)));
  const int columns = sums.cols;
  for (int row = 0; row < sums.rows; ++row) {
    const std::uint16_t* const __restrict from = sums.ptr<std::uint16_t>(row);
    std::uint8_t* const __restrict to = mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < columns; ++column) to[column] = from[column] > limit ? 255 : 0;
  }
}

/// Scatter of means over the board, from cell to cell: grain, and what is printed in patterns. Whatever
/// covers less than half of a cell, as a cut does, or less than half of the cells around, does not count.
class BoardScatter {
 public:
  /// `sums` has the sum of kBox pixels around each pixel.
  explicit BoardScatter(const cv::Mat& sums)
      : cells_((sums.rows + Background::kCellPx - 1) / Background::kCellPx,
               (sums.cols + Background::kCellPx - 1) / Background::kCellPx, CV_64F) {
    for (int row = 0; row < cells_.rows; ++row)
      for (int column = 0; column < cells_.cols; ++column)
        cells_.at<double>(row, column) = scatterIn(sums, cellAt(sums, row, column));
  }

  /// Pixels of a cell.
  static cv::Rect cellAt(const cv::Mat& picture, int row, int column) {
    constexpr int kCell = Background::kCellPx;
    const cv::Rect whole(column * kCell, row * kCell, kCell, kCell);
    return whole & cv::Rect(0, 0, picture.cols, picture.rows);
  }

  /// Standard deviation of a mean, gray: the median of the cell and of those around it.
  [[nodiscard]] double at(int row, int column) const {
    std::vector<double> around;
    for (int r = std::max(0, row - 1); r <= std::min(cells_.rows - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(cells_.cols - 1, column + 1); ++c)
        around.push_back(cells_.at<double>(r, c));
    return upperMedianIn(around);
  }
  [[nodiscard]] int rows() const { return cells_.rows; }
  [[nodiscard]] int columns() const { return cells_.cols; }

 private:
  static double scatterIn(const cv::Mat& sums, const cv::Rect& cell) {
    std::vector<int> values;
    values.reserve(static_cast<std::size_t>(cell.area()) / (kSampleStride * kSampleStride) + 1);
    for (int y = cell.y; y < cell.y + cell.height; y += kSampleStride)
      for (int x = cell.x; x < cell.x + cell.width; x += kSampleStride)
        values.push_back(sums.at<std::uint16_t>(y, x));
    const int middle = upperMedianIn(values);
    for (int& value : values) value = std::abs(value - middle);
    return kMadToSigma * upperMedianIn(values) / kBox;
  }

  cv::Mat cells_;
};

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
    // Tiles of the next one may not have been taken yet.
    if (unit.back().is_last) return unit;
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
  const GrayImage& image = view.tile.image;
  // Only read: OpenCV has no view of constant memory.
  const cv::Mat picture(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat sums;
  cv::boxFilter(picture, sums, CV_16U, cv::Size(kBoxPx, kBoxPx), cv::Point(-1, -1), false,
                cv::BORDER_REPLICATE);
  const BoardScatter scatter(sums);
  GrayImage places(image.width, image.height);
  cv::Mat mask(image.height, image.width, CV_8U, places.pixels.data());
  for (int row = 0; row < scatter.rows(); ++row) {
    for (int column = 0; column < scatter.columns(); ++column) {
      const cv::Rect cell = BoardScatter::cellAt(picture, row, column);
      const double board = view.background->at(cell.x, cell.y);
      const Eigen::Vector2d middle(cell.x + 0.5 * cell.width, cell.y + 0.5 * cell.height);
      const double open = open_gray * view.light.at(middle);
      const double above = std::max({kNoiseSigmas * view.noise_gray, kGrainSigmas * scatter.at(row, column),
                                     least_share * (open - board)});
      markAbove(sums(cell), kBox * (board + above), mask(cell));
    }
  }
  return places;
}

}  // namespace kerfbench::vision
