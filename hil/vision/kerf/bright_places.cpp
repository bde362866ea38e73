// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/bright_places.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "twin/base/image.h"
#include "twin/base/multiversion.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr double kNoiseSigmas = 3.0;  // Least contrast in sigmas of one pixel: nine sigmas of a mean of nine
                                      // where no grain correlates them.
constexpr double kGrainSigmas = 5.0;  // Least contrast in sigmas of the board's own grain.
constexpr int kBoxPx = 3;             // Side of the square whose mean is taken.
constexpr int kBox = kBoxPx * kBoxPx;
constexpr std::size_t kMostSum = kBox * 255;
constexpr int kSampleStride = 4;  // Pixels between samples of the grain.
constexpr int kCell = Background::kCellPx;

KERFBENCH_WIDE void addRows(const std::uint8_t* upper, const std::uint8_t* middle, const std::uint8_t* lower,
                            std::size_t count, std::uint16_t* __restrict sums) {
  for (std::size_t c = 0; c < count; ++c)
    sums[c] = static_cast<std::uint16_t>(upper[c] + middle[c] + lower[c]);
}

/// Sums of three neighbours; `in` has one more at both ends.
KERFBENCH_WIDE void addNeighbours(const std::uint16_t* in, std::size_t count,
                                  std::uint16_t* __restrict sums) {
  for (std::size_t c = 0; c < count; ++c) sums[c] = static_cast<std::uint16_t>(in[c] + in[c + 1] + in[c + 2]);
}

/// 255 where a sum is above a limit, otherwise 0.
KERFBENCH_WIDE void markAbove(const std::uint16_t* sums, std::uint16_t limit, std::size_t count,
                              std::uint8_t* __restrict mask) {
  for (std::size_t c = 0; c < count; ++c) mask[c] = sums[c] > limit ? 255 : 0;
}

/// Sums of kBox pixels around each pixel, row by row. Next to a border the nearest pixel stands for those
/// outside.
class BoxSums {
 public:
  explicit BoxSums(const GrayImage& image)
      : image_(image), width_(static_cast<std::size_t>(image.width)), columns_(width_ + 2), sums_(width_) {}

  const std::vector<std::uint16_t>& row(int r) {
    const auto line = [&](int at) {
      return image_.pixels.data() + static_cast<std::size_t>(std::clamp(at, 0, image_.height - 1)) * width_;
    };
    addRows(line(r - 1), line(r), line(r + 1), width_, columns_.data() + 1);
    columns_.front() = columns_[1];
    columns_.back() = columns_[width_];
    addNeighbours(columns_.data(), width_, sums_.data());
    return sums_;
  }

 private:
  const GrayImage& image_;
  std::size_t width_;
  std::vector<std::uint16_t> columns_;  ///< Sums of three rows.
  std::vector<std::uint16_t> sums_;
};

/// How often each sum was seen in a cell.
class SumCounts {
 public:
  void add(std::uint16_t sum) {
    ++counts_[sum];
    ++total_;
    least_ = std::min<std::size_t>(least_, sum);
    most_ = std::max<std::size_t>(most_, sum);
  }
  /// Median absolute deviation from the median, upper medians both; forgets what was added.
  int takeScatter() {
    const std::size_t half = total_ / 2 + 1;
    std::size_t middle = least_;
    for (std::size_t seen = counts_[middle]; seen < half; seen += counts_[middle]) ++middle;
    std::size_t away = 0;
    for (std::size_t seen = counts_[middle]; seen < half;) {
      ++away;
      if (middle >= away) seen += counts_[middle - away];
      if (middle + away <= kMostSum) seen += counts_[middle + away];
    }
    std::fill(counts_.begin() + static_cast<std::ptrdiff_t>(least_),
              counts_.begin() + static_cast<std::ptrdiff_t>(most_) + 1, std::uint16_t{0});
    total_ = most_ = 0;
    least_ = kMostSum;
    return static_cast<int>(away);
  }

 private:
  std::array<std::uint16_t, kMostSum + 1> counts_{};
  std::size_t total_{}, least_{kMostSum}, most_{};
};

/// Scatter of means over the board, from cell to cell: grain, and what is printed in patterns. Whatever
/// covers less than half of a cell, as a cut does, or less than half of the cells around, does not count.
class BoardScatter {
 public:
  BoardScatter(const GrayImage& image, BoxSums& sums)
      : rows_((image.height + kCell - 1) / kCell), columns_((image.width + kCell - 1) / kCell) {
    std::vector<SumCounts> counts(static_cast<std::size_t>(columns_));
    for (int top = 0; top < image.height; top += kCell) {
      for (int r = top; r < std::min(top + kCell, image.height); r += kSampleStride) {
        const std::vector<std::uint16_t>& row = sums.row(r);
        for (std::size_t c = 0; c < row.size(); c += kSampleStride) counts[c / kCell].add(row[c]);
      }
      for (SumCounts& cell : counts) cells_.push_back(kMadToSigma * cell.takeScatter() / kBox);
    }
  }

  /// Standard deviation of a mean, gray: the median of the cell and of those around it.
  [[nodiscard]] double at(int row, int column) const {
    std::vector<double> around;
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
        around.push_back(cells_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(c)]);
    return upperMedianIn(around);
  }

 private:
  int rows_, columns_;
  std::vector<double> cells_;
};

/// The largest sum of dark places of the cell that begins at a pixel.
std::uint16_t darkLimit(double board, double above) {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(std::clamp(kBox * (board + above), 0.0, kMost));
}

}  // namespace

GrayImage brightPlaces(const TileView& view, double open_gray, double least_share) {
  const GrayImage& image = view.tile.image;
  BoxSums sums(image);
  const BoardScatter scatter(image, sums);
  GrayImage places(image.width, image.height);
  for (int top = 0; top < image.height; top += kCell) {
    const int bottom = std::min(top + kCell, image.height);
    std::vector<std::uint16_t> limits;
    for (int left = 0; left < image.width; left += kCell) {
      const int width = std::min(kCell, image.width - left);
      const double board = view.background->at(left, top);
      const Eigen::Vector2d middle(left + 0.5 * width, top + 0.5 * (bottom - top));
      const double open = open_gray * view.light.at(middle);
      const double above =
          std::max({kNoiseSigmas * view.noise_gray, kGrainSigmas * scatter.at(top / kCell, left / kCell),
                    least_share * (open - board)});
      limits.push_back(darkLimit(board, above));
    }
    for (int r = top; r < bottom; ++r) {
      const std::vector<std::uint16_t>& row = sums.row(r);
      for (std::size_t left = 0; left < row.size(); left += kCell)
        markAbove(row.data() + left, limits[left / kCell], std::min<std::size_t>(kCell, row.size() - left),
                  places.row(r).data() + left);
    }
  }
  return places;
}

}  // namespace kerfbench::vision
