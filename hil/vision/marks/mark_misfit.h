// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "hil/vision/marks/constellation.h"

namespace kerfbench::vision {

/// A mark that lies farther from where the others put it than its uncertainty and theirs allow.
struct MarkMisfit {
  std::size_t pair{};  ///< Index of its pair; of three marks or fewer nobody knows which one moved.
  double off_mm{};     ///< From where the others put it.
  double most_mm{};    ///< What is allowed, in that direction.
};

/// The worst misfit of several marks to the motion that fits them all, if there is one beyond what happens by
/// chance; at least two pairs, each with its sigma_mm > 0.
///
/// Least squares leave a residual e_i of pair i with the covariance C_i, which its own sigma and the fit's
/// give. e_i' C_i^-1 e_i is chi square of two degrees of freedom (one for two pairs, whose distance alone is
/// redundant), and exceeds t with the probability exp(-t/2) (erfc(sqrt(t/2))). So t is chosen that all `n`
/// residuals together exceed it with the probability `chance` at most (Bonferroni). For three pairs and more
/// it is the test of a mark against the place where the others alone put it, s_i² C_i^-1 e_i.
///
/// @throws std::invalid_argument for fewer than two pairs, a sigma that is not > 0, or a chance outside (0,
/// 1).
std::optional<MarkMisfit> worstMisfit(std::span<const MarkPair> pairs, double chance);

}  // namespace kerfbench::vision
