// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/tables/aim_grid.h"

namespace kerfbench::calibrate {

/// Spot of a check without any correction: aimed at `aim`, the beam went to `spot`. Both in W, mm.
struct UncorrectedSpot {
  Eigen::Vector2d aim_W_mm{};
  Eigen::Vector2d spot_W_mm{};
};

/// Reading of a file with the place and the value of each node turned, d'(A p) = V d(p), with A and V of the
/// eight matrices of 0 and ±1 that map the axes onto themselves.
struct TableReading {
  Eigen::Matrix2i places{Eigen::Matrix2i::Identity()};
  Eigen::Matrix2i values{Eigen::Matrix2i::Identity()};
  friend bool operator==(const TableReading& a, const TableReading& b) {
    return a.places == b.places && a.values == b.values;
  }
  /// Such as "the file is transposed", "the file is mirrored in x, and its sign is turned".
  [[nodiscard]] std::string text() const;
};

/// All 64: the eight maps of the places times the eight of the values (signs, and the pair exchanged).
std::vector<TableReading> allReadings();

/// Grid in that reading; rows and columns turn about (0, 0).
AimGrid asRead(const AimGrid& grid, const TableReading& reading);

struct RecogniseOptions {
  double sigma_mm{0.02};  ///< Standard deviation of a coordinate of a spot, k = 1; > 0. By ruler rather 0.1.
  double most_share{0.25};     ///< RMS of what is left may be this share of the spots' own error, or 3 sigma.
  double rival_margin{25.0};   ///< Least lead over a rival's sum of squares, in variances.
  double reach_share{0.1};     ///< A spot may lie outside of the table by this share of its sides.
  double same_table_mm{0.01};  ///< Readings whose tables are nowhere farther apart are one.
};

/// Fit of one reading.
struct ReadingFit {
  TableReading reading;
  double rms_mm{};  ///< RMS of the beam's distance from where it was wanted, with this table.
};

struct Recognition {
  enum class Verdict { kAsRead, kOtherwise, kUndecided, kNoneFits };
  Verdict verdict{Verdict::kUndecided};
  TableReading reading;          ///< Best reading; the file as read where that is as good.
  std::vector<ReadingFit> fits;  ///< Fits of all readings, best first.
  double error_rms_mm{};         ///< RMS error of the spots without correction.
  std::size_t spots{};           ///< Number of spots that were used.
  std::string text;              ///< The verdict with its numbers.
};

/// Finds the reading of a table that brings the beam to where it is wanted. Exact, without a model of the
/// head: a beam aimed at a landed at s, so the right table says d(s) = a − s.
/// @throws std::invalid_argument for options out of range, spots that are not finite, or fewer than six spots
///   within reach of the table.
Recognition recognise(const AimGrid& grid, const std::vector<UncorrectedSpot>& spots,
                      const RecogniseOptions& options = {});

}  // namespace kerfbench::calibrate
