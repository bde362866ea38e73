// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::planner {

/// Correction of what the formula of the scan head leaves: pincushion, barrel and all other measured errors
/// (S4's correction data base).
class CorrectionTable {
 public:
  enum class Unit { kMm, kSteps };
  struct Value {
    Eigen::Vector2d d{Eigen::Vector2d::Zero()};         ///< Correction in the table's unit.
    Eigen::Matrix2d gradient{Eigen::Matrix2d::Zero()};  ///< Gradient d(d)/d(x, y), unit per mm.
  };

  /// Parses a table. @throws PlanError with every fault as "name:line: …". A grid of 3 x 3 to 1025 x 1025
  /// nodes.
  static CorrectionTable parse(const std::string& text, const std::string& name);
  /// Reads a table from a file. @throws PlanError as parse(), and if the file cannot be read.
  static CorrectionTable read(const std::string& path);

  [[nodiscard]] Unit unit() const { return unit_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] Eigen::AlignedBox2d area_mm() const;
  /// Correction at p_W; beyond the grid, that of the nearest place on its border.
  [[nodiscard]] Value at(const Eigen::Vector2d& p_W_mm) const;

  /// Largest difference in a cell's middle between cubics through neighbouring sets of four nodes: about the
  /// error of the interpolation, in the table's unit. 0 along an axis of fewer than five nodes, which cannot
  /// tell.
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
