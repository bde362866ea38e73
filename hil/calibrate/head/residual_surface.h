// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::calibrate {

/// Smooth functions over a rectangle: products of Legendre polynomials P_i(u) P_j(v), i + j <= degree, with
/// u, v = -1 … 1 over the rectangle. Beyond it the value of the nearest place on its border.
class SmoothBasis {
 public:
  /// @throws std::invalid_argument for an empty rectangle or a degree out of 0 … 30.
  SmoothBasis(const Eigen::AlignedBox2d& area_mm, int degree);

  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(orders_.size()); }
  [[nodiscard]] int degree() const { return degree_; }
  [[nodiscard]] const Eigen::AlignedBox2d& area_mm() const { return area_mm_; }
  /// i and j of function k; those of lower total degree come first.
  [[nodiscard]] const Eigen::Vector2i& order(Eigen::Index k) const {
    return orders_[static_cast<std::size_t>(k)];
  }

  struct Values {
    Eigen::VectorXd at;     ///< Value of each function.
    Eigen::MatrixX2d by_p;  ///< Slopes of each function, 1/mm.
  };
  [[nodiscard]] Values at(const Eigen::Vector2d& p_mm) const;
  [[nodiscard]] Eigen::VectorXd valuesAt(const Eigen::Vector2d& p_mm) const;

 private:
  [[nodiscard]] Eigen::Vector2d onUnitSquare(const Eigen::Vector2d& p_mm) const;

  Eigen::AlignedBox2d area_mm_;
  int degree_;
  std::vector<Eigen::Vector2i> orders_;
};

}  // namespace kerfbench::calibrate
