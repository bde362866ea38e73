// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::calibrate {

/// Interpolation of a table between its nodes.
enum class Between {
  kBilinear,
  /// Bicubic Hermite, with slopes at the nodes from the polynomial through five neighbours, or through all if
  /// there are fewer: what the reference controller does. Needs 3 x 3 nodes; on these it is biquadratic.
  kHermite,
};

/// Extrapolation of a table outside of its nodes.
enum class Outside {
  kRefused,  ///< Nothing.
  kClamped,  ///< The value of the nearest place on the border.
  kLinear,   ///< The bilinear surface of the cell at the border goes on.
};

/// A correction on a complete rectangular grid, whatever file it came from: a beam wanted at p in W is aimed
/// at p + d(p) in place of p. So d is to first order minus what the uncorrected beam is off, and zeros change
/// nothing. W: x along belt travel, y across, mm, (0, 0) under the resting beam.
class AimGrid {
 public:
  static constexpr std::size_t kMostNodes = 1025;  ///< Most nodes of a side.

  /// @param x_mm, y_mm places of columns and rows, ascending; distances need not be equal.
  /// @param d_mm y ascending, and for each y all x ascending.
  /// @throws std::invalid_argument with all of: fewer than 2 x 2 (Hermite: 3 x 3) or more than 1025 x 1025
  ///   nodes, places that do not ascend, another number of values, anything not finite.
  AimGrid(std::vector<double> x_mm, std::vector<double> y_mm, std::vector<Eigen::Vector2d> d_mm,
          Between between, Outside outside);

  [[nodiscard]] const std::vector<double>& x_mm() const { return x_; }
  [[nodiscard]] const std::vector<double>& y_mm() const { return y_; }
  [[nodiscard]] const std::vector<Eigen::Vector2d>& d_mm() const { return d_; }
  [[nodiscard]] const Eigen::Vector2d& d_mm(std::size_t column, std::size_t row) const {
    return d_[row * x_.size() + column];
  }
  [[nodiscard]] Between between() const { return between_; }
  [[nodiscard]] Outside outside() const { return outside_; }
  [[nodiscard]] Eigen::AlignedBox2d area_W_mm() const;

  /// nullopt outside of a grid that refuses what is outside, and for a place that is not finite. What lies
  /// less than 1e-9 mm outside, by rounding, counts as on the border.
  [[nodiscard]] std::optional<Eigen::Vector2d> at_mm(const Eigen::Vector2d& p_W_mm) const;

  /// Grid of the same nodes with another rule between and outside. @throws as the constructor.
  [[nodiscard]] AimGrid with(Between between, Outside outside) const;

 private:
  /// d/dx, d/dy, d²/dxdy at a node.
  using Slopes = std::array<Eigen::Vector2d, 3>;
  void setSlopes();
  [[nodiscard]] Eigen::Vector2d bilinear(const Eigen::Vector2d& p_W_mm) const;
  [[nodiscard]] Eigen::Vector2d hermite(const Eigen::Vector2d& p_W_mm) const;

  std::vector<double> x_, y_;
  std::vector<Eigen::Vector2d> d_;
  std::vector<Slopes> slopes_;  // Empty unless Hermite.
  Between between_;
  Outside outside_;
};

/// `count` places from `low` to `high`, both included, evenly. count >= 2.
std::vector<double> evenly(double low, double high, std::size_t count);

/// `from` read off at other nodes.
/// @throws std::invalid_argument as AimGrid; and if a node lies where `from` says nothing, naming the first.
AimGrid resampled(const AimGrid& from, std::vector<double> x_mm, std::vector<double> y_mm, Between between,
                  Outside outside);

}  // namespace kerfbench::calibrate
