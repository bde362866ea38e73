// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::inspect {

// Private to this room.

/// A largest value: normal about `mean`, mm, moved by some of the errors that many share, each of standard
/// deviation 1, and by others that it shares with no one.
struct Largest {
  double mean{};
  double variance{};  ///< In all, mm².
  /// Place among the shared errors, and by how much that error moves it, mm; by place, each once.
  std::vector<std::pair<Eigen::Index, double>> gradient;
};

/// The largest of many such values: its moments, and how each shared error moves it.
struct LargestOfAll {
  double mean{};
  double variance{};  ///< In all, mm².
  Eigen::VectorXd gradient;
};

/// Two at a time by Clark (1961, eqs. 2 to 5). An error that candidates share makes one larger by what it
/// takes from the other, and no slope tells that: the two directions that move most are integrated over, the
/// rest is taken as linear. `candidates` has at least one; `shared`: number of shared errors. Takes n log n
/// of the candidates.
LargestOfAll largestOfAll(const std::vector<Largest>& candidates, Eigen::Index shared);

}  // namespace kerfbench::inspect
