// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::planner {

/// What the formula of the scan head leaves: pincushion, barrel and all else that was measured (S4's
/// correction data base).
///
/// The file is CSV. A line that begins with '#' is a comment. The first other line is the header
///
///     x_mm,y_mm,dx_mm,dy_mm          or          x_mm,y_mm,dx_steps,dy_steps
///
/// and each one after it a node of a complete rectangular grid: y ascending, and for each y all x ascending;
/// the distances of the nodes need not be equal. (x, y) is where the beam is wanted, in W: x along belt
/// travel, y across, mm, (0, 0) under the resting beam. With dx_mm, dy_mm the head is aimed at (x + dx, y +
/// dy) in place of (x, y): what its formula turns into mirror angles. So dx, dy are to first order minus what
/// the uncorrected beam is off, and a table of zeros changes nothing. With dx_steps, dy_steps the numbers are
/// added to the steps that the formula gives, x first. Between nodes the correction is a bicubic Hermite
/// surface with continuous slopes. Outside of the grid there is none: a table that does not cover the whole
/// field is refused, and so is one whose grid is too coarse for its bends, or that turns the field over (two
/// places aimed at the same point).
class CorrectionTable {
 public:
  enum class Unit { kMm, kSteps };
  struct Value {
    Eigen::Vector2d d{Eigen::Vector2d::Zero()};         ///< In the table's unit.
    Eigen::Matrix2d gradient{Eigen::Matrix2d::Zero()};  ///< d(d)/d(x, y), unit per mm.
  };

  /// @throws PlanError with every fault as "name:line: …". A grid of 3 x 3 to 1025 x 1025 nodes.
  static CorrectionTable parse(const std::string& text, const std::string& name);
  /// @throws PlanError as parse(), and if the file cannot be read.
  static CorrectionTable read(const std::string& path);

  [[nodiscard]] Unit unit() const { return unit_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] Eigen::AlignedBox2d area_mm() const;
  /// At p_W; beyond the grid, that of the nearest place on its border.
  [[nodiscard]] Value at(const Eigen::Vector2d& p_W_mm) const;

  /// The largest difference in a cell's middle between cubics through neighbouring sets of four nodes: about
  /// what the interpolation may be off, in the table's unit. 0 along an axis of fewer than five nodes, which
  /// cannot tell.
  struct Coarseness {
    double error{};
    Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
  };
  [[nodiscard]] Coarseness coarseness() const;

 private:
  /// Values and slopes at a node: the correction, d/dx, d/dy, d²/dxdy.
  using Node = std::array<Eigen::Vector2d, 4>;
  void setSlopes();
  [[nodiscard]] const Node& node(std::size_t column, std::size_t row) const {
    return nodes_[row * x_.size() + column];
  }

  std::string name_;
  Unit unit_{Unit::kMm};
  std::vector<double> x_, y_;
  std::vector<Node> nodes_;
};

}  // namespace kerfbench::planner
