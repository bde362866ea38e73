// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/correction_table.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/LU>

#include "twin/base/symmetric_eigen.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

constexpr int kLeastNodes = 5;
constexpr int kMostNodes = static_cast<int>(AimGrid::kMostNodes);

Vector2d placeOf(const AimGrid& grid, std::size_t column, std::size_t row) {
  return {grid.x_mm()[column], grid.y_mm()[row]};
}

/// The table's error at a place: where the beam lands less where it was wanted.
double errorAt(const HeadFit& fit, const AimGrid& grid, const Vector2d& p) {
  const auto d = grid.at_mm(p);
  const auto spot = d ? fit.spotOf(p + *d) : std::nullopt;
  return spot ? (spot->p_W_mm - p).norm() : INFINITY;
}

/// Largest error in the middles of cells and of their edges.
double interpolationError(const HeadFit& fit, const AimGrid& grid) {
  const std::size_t nodes = grid.x_mm().size();
  const Eigen::AlignedBox2d area = grid.area_W_mm();
  const auto x = evenly(area.min().x(), area.max().x(), 2 * nodes - 1);
  const auto y = evenly(area.min().y(), area.max().y(), 2 * nodes - 1);
  double worst = 0.0;
  for (std::size_t row = 0; row < y.size(); ++row) {
    for (std::size_t column = 0; column < x.size(); ++column) {
      if (row % 2 == 0 && column % 2 == 0) continue;  // A node: exact.
      worst = std::max(worst, errorAt(fit, grid, {x[column], y[row]}));
    }
  }
  return worst;
}

/// How far cubics through neighbouring sets of four of these values differ at most in the middle of a cell.
/// By Newton's form it is their fourth difference times (z - x1)(z - x2)(z - x3) / 6 h³.
double cubicsDiffer(std::size_t count, const auto& value) {
  double worst = 0.0;
  for (std::size_t first = 0; first + 5 <= count; ++first) {
    const auto at = [&](std::size_t k) -> const Vector2d& { return value(first + k); };
    const Vector2d fourth = at(0) - 4.0 * at(1) + 6.0 * at(2) - 4.0 * at(3) + at(4);
    const bool rim = first == 0 || first + 5 == count;  // There the first cell or the last is looked at too.
    worst = std::max(worst, (rim ? 5.0 : 1.0) / 16.0 * fourth.norm());
  }
  return worst;
}

double cubicsDiffer(const AimGrid& grid) {
  const std::size_t nodes = grid.x_mm().size();
  double worst = 0.0;
  for (std::size_t line = 0; line < nodes; ++line) {
    const double row = cubicsDiffer(
        nodes, [&](std::size_t k) -> auto& { return grid.d_mm(k, line); });
    const double column = cubicsDiffer(
        nodes, [&](std::size_t k) -> auto& { return grid.d_mm(line, k); });
    worst = std::max({worst, row, column});
  }
  return worst;
}

AimGrid gridOf(const HeadFit& fit, const Eigen::AlignedBox2d& area, std::size_t nodes) {
  const auto x = evenly(area.min().x(), area.max().x(), nodes);
  const auto y = evenly(area.min().y(), area.max().y(), nodes);
  std::vector<Vector2d> d_mm;
  for (std::size_t row = 0; row < nodes; ++row) {
    for (std::size_t column = 0; column < nodes; ++column) {
      const Vector2d p(x[column], y[row]);
      const auto aim = fit.aimFor(p);
      if (!aim) {
        throw HeadCalibrationError(fmt::format(
            "the beam does not get to ({:.1f}, {:.1f}) mm, whatever it is aimed at", p.x(), p.y()));
      }
      d_mm.emplace_back(*aim - p);
    }
  }
  return {x, y, d_mm, Between::kHermite, Outside::kRefused};
}

/// The sign of the area that each cell's aims enclose must be that of the wiring everywhere.
void refuseFolds(const AimGrid& grid, double sign) {
  const auto aim = [&](std::size_t column, std::size_t row) -> Vector2d {
    return placeOf(grid, column, row) + grid.d_mm(column, row);
  };
  for (std::size_t row = 0; row + 1 < grid.y_mm().size(); ++row) {
    for (std::size_t column = 0; column + 1 < grid.x_mm().size(); ++column) {
      const Vector2d right = aim(column + 1, row) - aim(column, row);
      const Vector2d up = aim(column, row + 1) - aim(column, row);
      if (sign * (right.x() * up.y() - right.y() * up.x()) > 0.0) continue;
      const Vector2d p = placeOf(grid, column, row);
      throw HeadCalibrationError(
          fmt::format("near ({:.1f}, {:.1f}) mm two places want the same aim", p.x(), p.y()));
    }
  }
}

void check(const CorrectionTableOptions& options) {
  const bool fine = !options.field_W_mm.isEmpty() && options.field_W_mm.sizes().minCoeff() > 0.0 &&
                    options.margin_share >= 0.0 && options.margin_share <= 1.0 &&
                    options.interpolation_error_mm > 0.0 && options.cubics_differ_mm > 0.0 &&
                    options.least_nodes >= kLeastNodes && options.most_nodes <= kMostNodes &&
                    options.least_nodes <= options.most_nodes;
  if (!fine) {
    throw std::invalid_argument(
        "a table needs a field, a margin of 0 … 1, errors above 0, and 5 <= least_nodes <= most_nodes <= "
        "1025");
  }
}

void describe(const HeadFit& fit, CorrectionTableResult& table) {
  for (std::size_t row = 0; row < table.grid.y_mm().size(); ++row) {
    for (std::size_t column = 0; column < table.grid.x_mm().size(); ++column) {
      const Vector2d& d = table.grid.d_mm(column, row);
      table.largest_correction_mm = std::max(table.largest_correction_mm, d.norm());
      const auto covariance = fit.covarianceAt_mm2(placeOf(table.grid, column, row) + d);
      if (!covariance) continue;  // Cannot be: the node's aim was found by this fit.
      const double most = SymmetricEigen<2>(*covariance).values[1];
      table.largest_sigma_mm = std::max(table.largest_sigma_mm, std::sqrt(most));
    }
  }
}

}  // namespace

CorrectionTableResult correctionTable(const HeadFit& fit, const CorrectionTableOptions& options) {
  check(options);
  const Vector2d margin = options.margin_share * options.field_W_mm.sizes();
  const Eigen::AlignedBox2d area(options.field_W_mm.min() - margin, options.field_W_mm.max() + margin);
  double error_mm = INFINITY;
  double differ_mm = INFINITY;
  for (int nodes = options.least_nodes; nodes <= options.most_nodes; nodes = 2 * nodes - 1) {
    CorrectionTableResult table{gridOf(fit, area, static_cast<std::size_t>(nodes))};
    refuseFolds(table.grid, fit.axes().matrix().determinant());
    table.interpolation_error_mm = error_mm = interpolationError(fit, table.grid);
    differ_mm = cubicsDiffer(table.grid);
    if (error_mm > options.interpolation_error_mm || differ_mm > options.cubics_differ_mm) continue;
    describe(fit, table);
    return table;
  }
  throw HeadCalibrationError(fmt::format(
      "even the finest grid of {} nodes a side is too coarse: off by {:.4f} mm between its nodes ({:g} may "
      "be), cubics through them differ by {:.4f} mm ({:g} may be)",
      options.most_nodes, error_mm, options.interpolation_error_mm, differ_mm, options.cubics_differ_mm));
}

}  // namespace kerfbench::calibrate
