// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench::test {

/// Limits that are claimed of `calibrate head`.
inline constexpr int kMostIterations = 3;
inline constexpr double kLeastCover = 0.94, kMostCover = 0.97;

/// A head with hidden faults and how its calibration ended.
struct CalibratedHead {
  std::uint64_t seed{};
  std::string error;    ///< Reason why there is no table; all fields below are empty then.
  double raw_mm{};      ///< Largest error of the first marks, without a table.
  int iterations{};     ///< Number of iterations up to the best table.
  double max_mm{};      ///< Largest error at the places that verify it.
  double rms_mm{};      ///< RMS of the errors at these places.
  double largest_mm{};  ///< Largest error anywhere in the field, as it is stated,
  double U_mm{};        ///< with its U.
  std::size_t places{};
  std::size_t covered{};  ///< Number of places within the ellipse that should hold 95 %.
  /// Largest error that is not excluded.
  [[nodiscard]] double most_mm() const { return largest_mm + U_mm; }
  double wall_s{};  ///< Duration; 0: a part was measured by an earlier run.
};

/// Share of places within the ellipse, over several heads.
struct Cover {
  double share{};
  /// Standard error by the scatter between seeds: places of one head share its fit and the poses of its
  /// sheets, and heads of one seed share the twin's samples of that seed, on any machine.
  double sigma{};
  std::size_t heads{}, seeds{};
};
Cover coverOf(const std::vector<CalibratedHead>& heads);

/// All heads of one machine.
struct HeadKindProof {
  std::string machine;
  double limit_mm{};
  std::vector<CalibratedHead> heads;
};

/// Every claim that does not hold, in words: a head without a table, not proven to be within its limit or
/// with a place beyond it, after too many
/// iterations; and, over all heads with the same number of iterations, a share of covered places whose 95 %
/// interval lies outside kLeastCover … kMostCover. With fewer than ten seeds the share is not judged.
std::vector<std::string> brokenClaims(const std::vector<HeadKindProof>& proof);

/// Table with one line for each machine, with a heading.
std::string tableOf(const std::vector<HeadKindProof>& proof);
/// CSV with one line for each head.
std::string csvOf(const std::vector<HeadKindProof>& proof);

}  // namespace kerfbench::test
