// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/base/random.h"
#include "twin/camera/projection.h"
#include "twin/camera/spline_weights.h"

namespace kerfbench::twin {

/// A random pattern fixed to the board: a pure function of seed, stream and place. It has zero mean, RMS 1
/// (4 % more on the nodes of its lattice, 4 % less between them, in each direction), is normal, never beyond
/// 7.8, and smooth: a uniform cubic B-spline over white noise. Its correlation falls to 1/e at the given
/// length.
class BoardField {
 public:
  static constexpr double kLimit = 7.8;

  BoardField(std::uint64_t seed, std::uint64_t stream, double length_mm);

  /// Spacing of the lattice, mm.
  [[nodiscard]] double nodePitch_mm() const { return pitch_mm_; }
  /// Copies the coefficients [column, column + columns) x [row, row + rows), row-major, into `out`.
  void copyNodes(int column, int row, int columns, int rows, std::span<float> out) const;
  [[nodiscard]] double at(const Eigen::Vector2d& p_mm) const;

 private:
  CounterRandom random_;
  double pitch_mm_;
};

/// Coefficients of a field around a small piece of board.
class FieldWindow {
 public:
  /// Copies the coefficients around a box of the board, given in spacings of the lattice.
  void fill(const BoardField& field, const Eigen::AlignedBox2d& box_nodes);
  /// Place of the first coefficient, in spacings of the lattice; at() counts from there.
  [[nodiscard]] Eigen::Vector2d origin() const { return {column_, row_}; }
  [[nodiscard]] float at(float x, float y, const SplineWeightTable& weights) const {
    // Conversion through int: the processor has no instruction from float to size_t.
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const float* const around = nodes_.data() + ((row - 1) * stride_ + (column - 1));
    return splineValue(around, static_cast<std::size_t>(stride_), weights.at(x - static_cast<float>(column)),
                       weights.at(y - static_cast<float>(row)));
  }

 private:
  int column_{}, row_{};
  int stride_{};
  std::vector<float> nodes_;
};

/// Draws the field as a small piece of a picture shows it.
class FieldPainter {
 public:
  explicit FieldPainter(const BoardField& field) : field_(field) {}

  /// Adds `scale` times the field to width x height pixels, whose centres lie at s = (x + 0.5) / width, t =
  /// (y + 0.5) / height of a patch through these points of the board.
  void add(const PlanePatch::Nodes& p_S_mm, int width, int height, float scale, std::span<float> out);

 private:
  const BoardField& field_;
  SplineWeightTable weights_;
  FieldWindow window_;
};

}  // namespace kerfbench::twin
