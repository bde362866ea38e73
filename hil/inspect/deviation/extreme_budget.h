// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::inspect {

/// One place of a line that may be the farthest off.
struct ExtremePoint {
  double likely{};  ///< Likely true deviation.
  double seen{};    ///< What the smoother makes of it.
  double sigma{};   ///< Standard uncertainty of the estimate by noise.
  double
      correlation{};  ///< Correlation of the noise with that of the point before; 0 for the first of a run.
  Eigen::RowVectorXd shared;  ///< As a row of ReadingLine::shared.
};

/// A line, or the part of one that lies in one tile.
struct ExtremeLine {
  int unit{};
  std::vector<Eigen::Index> tiles;  ///< ReadingLine::tiles.
  std::vector<ExtremePoint> points;
};

/// What of a line has to be known before the parts of any are looked at.
struct ExtremeHeights {
  int unit{};
  double seen{};    ///< Largest |seen|.
  double likely{};  ///< Largest |likely|.
  /// Some value of the line lies higher for certain.
  double floor{-std::numeric_limits<double>::infinity()};
  double reach{-std::numeric_limits<double>::infinity()};  ///< No value of the line comes so far.
  Eigen::Index camera{-1};  ///< Shared errors that are neither its own nor a tile's; -1: it has no points.

  void add(const ExtremeLine& part);
};

/// Analytic uncertainty of max |deviation| over all points of all lines.
struct ExtremeBudget {
  double extreme_bias{};    ///< Mean of the largest |seen + errors| less the largest |seen|.
  double smoothing_bias{};  ///< Largest |seen| less the largest |likely|.
  double u_noise{};         ///< Part by noise, by errors of single lines, and by which line is the largest.
  double u_pose{};          ///< Part by errors that the lines of a unit share.
  double u_table{};         ///< Part by errors that all readings in a tile share.
  double u_camera{};        ///< Part by errors that all share.
};

/// Distribution for one line: that no value of its noise lies above w is taken as a Markov chain of
/// neighbours,
///
///     P(max <= w) = prod over runs: Phi(z_1) · prod (1 - P(Z_i-1 <= z_i-1, Z_i > z_i) / Phi(z_i-1)),
///     P(Z1 <= a, Z2 > b) = Phi(a) - Phi(min(a, b))
///         + 1/(2 pi) · integral from 0 to acos r of exp(-(a² + b² - 2 a b cos t) / (2 sin² t)) dt,
///
/// exact for two normal values of correlation r; for a = b it is Rice's (1945) crossing rate. Its mean, its
/// variance and how shared errors move it make each side of the line one normal value; the largest of those,
/// which are correlated, has the moments that Clark (1961, eqs. 2 to 5) gives for two, one after the other.
/// Over the two directions of the shared errors that move most the result is integrated, for opposite
/// sides part by them.
/// `tiles` is ErrorModel::tiles. The result is the same at any number of threads.
ExtremeBudget extremeBudget(const std::vector<ExtremeLine>& lines, Eigen::Index tiles = 0, int threads = 1);

/// The parts of a line, made when they are looked at; several threads may ask.
using PartsOfLine = std::function<std::vector<ExtremeLine>(std::size_t line)>;
/// The same of more lines than fit into memory. `heights` has one for each.
ExtremeBudget extremeBudget(const std::vector<ExtremeHeights>& heights, const PartsOfLine& parts,
                            Eigen::Index tiles, int threads);

}  // namespace kerfbench::inspect
