// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace kerfbench::vision {

// Private to this room: pixels of one look at a printed disc, collected from its rows, so that sums over them
// take several at a time. Sums go by lanes, each in its order: the result is the same on every processor.

/// Pixels by their places from the disc's centre, px, and their gray.
struct DiscPixels {
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kMost = 512;  ///< A multiple of the lanes.

  std::size_t count{0};
  std::array<float, kMost> x, y, gray;

  /// Makes numbers of what lies behind the last pixel, up to the next whole number of lanes.
  void pad() {
    for (std::size_t i = count; i % kLanes != 0; ++i) x[i] = y[i] = gray[i] = 0.0F;
  }
  /// Adds a row's pixels; its first lies at x_px. `take(pixels)` empties the list whenever it is full.
  template <typename Level, typename Take>
  void add(const Level* levels, int size, double x_px, double y_px, float per_level, const Take& take) {
    for (int begin = 0; begin < size;) {
      const int n = std::min(size - begin, static_cast<int>(kMost - count));
      for (int k = 0; k < n; ++k) {
        const std::size_t i = count + static_cast<std::size_t>(k);
        x[i] = static_cast<float>(x_px) + static_cast<float>(begin + k);
        y[i] = static_cast<float>(y_px);
        gray[i] = per_level * static_cast<float>(levels[begin + k]);
      }
      count += static_cast<std::size_t>(n);
      begin += n;
      if (count < kMost) continue;
      take(*this);
      count = 0;
    }
  }
};

/// Sum over pixels.
class LaneSum {
 public:
  double& operator[](std::size_t lane) { return lane_[lane]; }
  [[nodiscard]] double total() const {
    double sum = 0.0;
    for (const double lane : lane_) sum += lane;
    return sum;
  }

 private:
  std::array<double, DiscPixels::kLanes> lane_{};
};

/// Grays that count, where the light is as it is at the disc's centre; it changes by these shares per pixel.
struct GrayRange {
  float least, most, slope_x, slope_y;
};

/// Sums over the pixels within a range, of places and grays and their products; and how many lie below and
/// above it.
struct GrayMoments {
  LaneSum n, x, y, gray, xx, xy, yy, x_gray, y_gray, gray2, below, above;
};
void addMoments(const DiscPixels& pixels, const GrayRange& range, GrayMoments& sums);

constexpr std::size_t kSectors = 12;

/// The edge of a disc: ink turns to board over a few pixels, blurred as a straight edge is.
struct DiscEdge {
  float board, per_gray;  ///< Share of ink of a pixel: board - per_gray * gray.
  float slope_x, slope_y;
  Eigen::Matrix2f circle;  ///< Turns the ellipse in the picture into a circle of the same area.
  float radius_px;
};

/// Sums over the edge's pixels: of shares of ink, times the place; and by its sectors, counted as atan2 goes,
/// from -x, of what exceeds the shares of a round disc. Half the squared distance from the centre, alone and
/// times the gray that it would have in even light.
struct EdgeSums {
  LaneSum ink, x, y, half_square, half_square_gray;
  std::array<double, kSectors> beyond{};
};
/// The last three sums only if `compare`.
void addEdge(const DiscPixels& pixels, const DiscEdge& edge, bool compare, EdgeSums& sums);

}  // namespace kerfbench::vision
