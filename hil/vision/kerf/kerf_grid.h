// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::vision {

/// A point of the dieline, short against a caliper from the next one.
struct CurveSample {
  Eigen::Vector2d p_S_mm;
  Eigen::Vector2d tangent;
  double curvature_per_mm;
  double station_mm;
  std::size_t plan;
};

/// Finds the samples around a point.
class SampleGrid {
 public:
  explicit SampleGrid(double cell_mm) : cell_mm_(cell_mm) {}

  void add(const CurveSample& sample) {
    cells_[key(index(sample.p_S_mm.x()), index(sample.p_S_mm.y()))].push_back(sample);
  }

  /// Calls see(sample) for all within a cell's size, and some that are farther; in the order of cells.
  template <typename See>
  void around(const Eigen::Vector2d& p_mm, const See& see) const {
    const std::int64_t cx = index(p_mm.x());
    const std::int64_t cy = index(p_mm.y());
    for (std::int64_t y = cy - 1; y <= cy + 1; ++y) {
      for (std::int64_t x = cx - 1; x <= cx + 1; ++x) {
        const auto cell = cells_.find(key(x, y));
        if (cell != cells_.end()) std::for_each(cell->second.begin(), cell->second.end(), see);
      }
    }
  }

 private:
  [[nodiscard]] std::int64_t index(double mm) const {
    return static_cast<std::int64_t>(std::floor(mm / cell_mm_));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffULL);
  }
  double cell_mm_;
  std::unordered_map<std::uint64_t, std::vector<CurveSample>> cells_;
};

}  // namespace kerfbench::vision
