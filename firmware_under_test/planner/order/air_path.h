// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "firmware_under_test/planner/order/chains.h"

namespace kerfbench::planner {

/// A chain in its place in the order of cutting.
struct Stop {
  Chain chain;
  /// Rank: a chain of a lower rank is cut before one of a higher, as far as the given order does so.
  int rank{};
  bool has_bridges{};  ///< True where the chain is a perforation whose cuts are already laid.
};

/// Length of path with the laser off from the first mark to the last.
double airPathMm(const std::vector<Stop>& order);

/// Shortens the air path of an order by 2-opt, Or-opt, reversing open chains and beginning closed ones
/// elsewhere (at another corner, where a chain has any). No pair that is in the sequence of its ranks leaves
/// it. Starts anew from disturbed orders, with a seed of its own: same input, same output.
///
/// `fits` says whether an order can be cut, as on a moving sheet; it is called for each better order, no more
/// than `most_questions` times, and the given order is taken to fit. Empty: every order does.
std::vector<Stop> shortened(std::vector<Stop> order,
                            const std::function<bool(const std::vector<Stop>&)>& fits, int most_questions);

/// Keeps an order, and chooses in which sense each open chain is run and where each closed one begins, so
/// that the air path is the shortest of all such choices.
std::vector<Stop> withNearestStarts(std::vector<Stop> order);

}  // namespace kerfbench::planner
