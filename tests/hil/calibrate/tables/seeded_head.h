// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/recognise.h"
#include "hil/calibrate/tables/table_faults.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {

/// A head whose beam, aimed at a, goes elsewhere: full cubic polynomials of both places, no symmetry, a few
/// mm at the corners of a field of ±half_mm.
class SeededHead {
 public:
  SeededHead(std::uint64_t seed, double half_mm, double size_mm = 2.0) : half_mm_(half_mm) {
    const CounterRandom random(seed, 0);
    for (std::uint64_t i = 0; i < kTerms; ++i)
      coefficients_.emplace_back(size_mm * random.normal(2 * i) / 4.0,
                                 size_mm * random.normal(2 * i + 1) / 4.0);
  }
  [[nodiscard]] Eigen::Vector2d spotFor(const Eigen::Vector2d& aim) const {
    const double u = aim.x() / half_mm_;
    const double v = aim.y() / half_mm_;
    const double terms[kTerms]{1.0, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v};
    Eigen::Vector2d spot = aim;
    for (std::size_t i = 0; i < kTerms; ++i) spot += terms[i] * coefficients_[i];
    return spot;
  }
  /// Aim that brings the beam to p.
  [[nodiscard]] Eigen::Vector2d aimFor(const Eigen::Vector2d& p) const {
    Eigen::Vector2d aim = p;
    for (int i = 0; i < 200; ++i) aim += p - spotFor(aim);
    return aim;
  }
  [[nodiscard]] AimGrid table(const std::vector<double>& x, const std::vector<double>& y,
                              Between between = Between::kHermite,
                              Outside outside = Outside::kRefused) const {
    std::vector<Eigen::Vector2d> d;
    for (const double py : y) {
      for (const double px : x) d.emplace_back(aimFor({px, py}) - Eigen::Vector2d(px, py));
    }
    return {x, y, std::move(d), between, outside};
  }
  /// Nine marks without correction, at 0.8 of the field.
  [[nodiscard]] std::vector<UncorrectedSpot> nineSpots(double sigma_mm = 0.0, std::uint64_t seed = 0) const {
    std::vector<UncorrectedSpot> spots;
    const CounterRandom noise(seed, 1);
    for (int row = -1; row <= 1; ++row) {
      for (int column = -1; column <= 1; ++column) {
        const Eigen::Vector2d aim = 0.8 * half_mm_ * Eigen::Vector2d(column, row);
        const auto i = static_cast<std::uint64_t>(2 * spots.size());
        spots.push_back(
            {aim, spotFor(aim) + sigma_mm * Eigen::Vector2d(noise.normal(i), noise.normal(i + 1))});
      }
    }
    return spots;
  }

 private:
  static constexpr std::size_t kTerms = 10;
  double half_mm_;
  std::vector<Eigen::Vector2d> coefficients_;
};

/// Faults that a reading reports; "" if none.
inline std::string faultsOf(const std::function<void()>& read) {
  try {
    read();
  } catch (const TableFileError& e) {
    return e.what();
  }
  return {};
}

/// Largest difference of two grids' values, mm, at places between and at the nodes of the first.
inline double farthest_mm(const AimGrid& a, const AimGrid& b) {
  double most = 0.0;
  const Eigen::AlignedBox2d area = a.area_W_mm();
  constexpr int kSide = 97;
  for (int row = 0; row <= kSide; ++row) {
    for (int column = 0; column <= kSide; ++column) {
      const Eigen::Vector2d share(1.0 * column / kSide, 1.0 * row / kSide);
      const Eigen::Vector2d p = area.min() + share.cwiseProduct(area.sizes());
      const auto da = a.at_mm(p);
      const auto db = b.at_mm(p);
      if (!da || !db) return INFINITY;
      most = std::max(most, (*da - *db).norm());
    }
  }
  return most;
}

}  // namespace kerfbench::calibrate
