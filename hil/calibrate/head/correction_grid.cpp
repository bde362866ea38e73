// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/correction_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace kerfbench::hil {
namespace {

using Eigen::Vector2d;

constexpr int kLeastNodes = 5;
constexpr int kMostNodes = 1025;

/// Derivative at node i of n, per cell, of the polynomial through five neighbours: the middle one, or as near
/// to it as the border allows (Fornberg 1988, table 3). `at(k)`: the value at node k.
template <typename At>
Vector2d fivePointSlope(int i, int n, const At& at) {
  static constexpr std::array<std::array<double, 5>, 5> kWeights{{{-25, 48, -36, 16, -3},
                                                                  {-3, -10, 18, -6, 1},
                                                                  {1, -8, 0, 8, -1},
                                                                  {-1, 6, -18, 10, 3},
                                                                  {3, -16, 36, -48, 25}}};
  const int first = std::clamp(i - 2, 0, n - 5);
  Vector2d sum = Vector2d::Zero();
  for (int k = 0; k < 5; ++k)
    sum += kWeights[static_cast<std::size_t>(i - first)][static_cast<std::size_t>(k)] * at(first + k);
  return sum / 12.0;
}

/// Where a place lies among n nodes: its cell, and how far in it, 0 … 1.
struct InCell {
  int cell{};
  double share{};
  InCell(double place, double low, double high, int n) {
    const double at = std::clamp((place - low) / (high - low), 0.0, 1.0) * (n - 1);
    cell = std::min(static_cast<int>(at), n - 2);
    share = at - cell;
  }
};

/// The cubic with these values and slopes at 0 and 1.
Vector2d hermite(const Vector2d& f0, const Vector2d& f1, const Vector2d& s0, const Vector2d& s1, double u) {
  const Vector2d rise = f1 - f0;
  return f0 + u * (s0 + u * ((3.0 * rise - 2.0 * s0 - s1) + u * (s0 + s1 - 2.0 * rise)));
}

/// The table's error at a place: where the beam lands less where it was wanted.
double errorAt(const HeadFit& fit, const CorrectionGrid& grid, const Vector2d& p) {
  const auto spot = fit.spotOf(p + grid.at_mm(p));
  return spot ? (spot->p_W_mm - p).norm() : INFINITY;
}

/// Largest error in the middles of cells and of their edges.
double interpolationError(const HeadFit& fit, const CorrectionGrid& grid) {
  const Vector2d half = 0.5 * (grid.place_W_mm(1, 1) - grid.place_W_mm(0, 0));
  double worst = 0.0;
  for (int row = 0; row < 2 * grid.rows() - 1; ++row) {
    for (int column = 0; column < 2 * grid.columns() - 1; ++column) {
      if (row % 2 == 0 && column % 2 == 0) continue;  // A node: exact.
      const Vector2d p = grid.area_W_mm().min() + Vector2d(column * half.x(), row * half.y());
      worst = std::max(worst, errorAt(fit, grid, p));
    }
  }
  return worst;
}

CorrectionGrid gridOf(const HeadFit& fit, const Eigen::AlignedBox2d& area, int nodes) {
  std::vector<Vector2d> d_mm;
  for (int row = 0; row < nodes; ++row) {
    for (int column = 0; column < nodes; ++column) {
      const Vector2d share(1.0 * column / (nodes - 1), 1.0 * row / (nodes - 1));
      const Vector2d p = area.min() + share.cwiseProduct(area.sizes());
      const auto aim = fit.aimFor(p);
      if (!aim) {
        throw HeadCalibrationError(fmt::format(
            "the beam does not get to ({:.1f}, {:.1f}) mm, whatever it is aimed at", p.x(), p.y()));
      }
      d_mm.emplace_back(*aim - p);
    }
  }
  return {area, nodes, nodes, d_mm};
}

/// The sign of the area that each cell's aims enclose must be that of the wiring everywhere.
void refuseFolds(const CorrectionGrid& grid, double sign) {
  const auto aim = [&](int column, int row) -> Vector2d {
    return grid.place_W_mm(column, row) + grid.d_mm(column, row);
  };
  for (int row = 0; row + 1 < grid.rows(); ++row) {
    for (int column = 0; column + 1 < grid.columns(); ++column) {
      const Vector2d right = aim(column + 1, row) - aim(column, row);
      const Vector2d up = aim(column, row + 1) - aim(column, row);
      if (sign * (right.x() * up.y() - right.y() * up.x()) > 0.0) continue;
      const Vector2d p = grid.place_W_mm(column, row);
      throw HeadCalibrationError(
          fmt::format("near ({:.1f}, {:.1f}) mm two places want the same aim", p.x(), p.y()));
    }
  }
}

void check(const CorrectionGridOptions& options) {
  const bool fine = !options.field_W_mm.isEmpty() && options.field_W_mm.sizes().minCoeff() > 0.0 &&
                    options.margin_share >= 0.0 && options.margin_share <= 1.0 &&
                    options.interpolation_error_mm > 0.0 && options.least_nodes >= kLeastNodes &&
                    options.most_nodes <= kMostNodes && options.least_nodes <= options.most_nodes;
  if (!fine) {
    throw std::invalid_argument(
        "a table needs a field, a margin of 0 … 1, an error above 0, and 5 <= least_nodes <= most_nodes <= "
        "1025");
  }
}

void describe(const HeadFit& fit, CorrectionTableResult& table) {
  for (int row = 0; row < table.grid.rows(); ++row) {
    for (int column = 0; column < table.grid.columns(); ++column) {
      const Vector2d& d = table.grid.d_mm(column, row);
      table.largest_correction_mm = std::max(table.largest_correction_mm, d.norm());
      const auto covariance = fit.covarianceAt_mm2(table.grid.place_W_mm(column, row) + d);
      if (!covariance) continue;  // Cannot be: the node's aim was found by this fit.
      const double most = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(*covariance).eigenvalues()[1];
      table.largest_sigma_mm = std::max(table.largest_sigma_mm, std::sqrt(most));
    }
  }
}

}  // namespace

CorrectionGrid::CorrectionGrid(const Eigen::AlignedBox2d& area_W_mm, int columns, int rows,
                               const std::vector<Vector2d>& d_mm)
    : area_W_mm_(area_W_mm), columns_(columns), rows_(rows) {
  if (std::min(columns, rows) < kLeastNodes || std::max(columns, rows) > kMostNodes)
    throw std::invalid_argument("a grid has 5 x 5 to 1025 x 1025 nodes");
  if (area_W_mm.isEmpty() || !(area_W_mm.sizes().minCoeff() > 0.0))
    throw std::invalid_argument("a grid's area must not be empty");
  if (d_mm.size() != static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows))
    throw std::invalid_argument("a grid needs a value for each node");
  for (const Vector2d& d : d_mm) nodes_.push_back({d, Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero()});
  setSlopes();
}

void CorrectionGrid::setSlopes() {
  const auto at = [&](int column, int row) -> Node& {
    return nodes_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  };
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      at(column, row).by_u = fivePointSlope(column, columns_, [&](int k) { return at(k, row).d; });
      at(column, row).by_v = fivePointSlope(row, rows_, [&](int k) { return at(column, k).d; });
    }
  }
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column)
      at(column, row).by_uv = fivePointSlope(row, rows_, [&](int k) { return at(column, k).by_u; });
  }
}

Vector2d CorrectionGrid::place_W_mm(int column, int row) const {
  const Vector2d share(1.0 * column / (columns_ - 1), 1.0 * row / (rows_ - 1));
  return area_W_mm_.min() + share.cwiseProduct(area_W_mm_.sizes());
}

const Vector2d& CorrectionGrid::d_mm(int column, int row) const { return node(column, row).d; }

Vector2d CorrectionGrid::at_mm(const Vector2d& p_W_mm) const {
  const InCell u(p_W_mm.x(), area_W_mm_.min().x(), area_W_mm_.max().x(), columns_);
  const InCell v(p_W_mm.y(), area_W_mm_.min().y(), area_W_mm_.max().y(), rows_);
  // Along x at both rows, value and slope across; then along y.
  std::array<Vector2d, 2> value, slope;
  for (int k = 0; k < 2; ++k) {
    const Node& left = node(u.cell, v.cell + k);
    const Node& right = node(u.cell + 1, v.cell + k);
    const auto at = static_cast<std::size_t>(k);
    value[at] = hermite(left.d, right.d, left.by_u, right.by_u, u.share);
    slope[at] = hermite(left.by_v, right.by_v, left.by_uv, right.by_uv, u.share);
  }
  return hermite(value[0], value[1], slope[0], slope[1], v.share);
}

CorrectionTableResult correctionTable(const HeadFit& fit, const CorrectionGridOptions& options) {
  check(options);
  const Vector2d margin = options.margin_share * options.field_W_mm.sizes();
  const Eigen::AlignedBox2d area(options.field_W_mm.min() - margin, options.field_W_mm.max() + margin);
  double error_mm = INFINITY;
  for (int nodes = options.least_nodes; nodes <= options.most_nodes; nodes = 2 * nodes - 1) {
    CorrectionTableResult table{gridOf(fit, area, nodes)};
    refuseFolds(table.grid, fit.axes().matrix().determinant());
    table.interpolation_error_mm = error_mm = interpolationError(fit, table.grid);
    if (error_mm > options.interpolation_error_mm) continue;
    describe(fit, table);
    return table;
  }
  throw HeadCalibrationError(fmt::format(
      "even the finest grid of {} nodes a side is off by {:.4f} mm between its nodes, more than {:g}",
      options.most_nodes, error_mm, options.interpolation_error_mm));
}

}  // namespace kerfbench::hil
