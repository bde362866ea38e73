// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/order/air_path.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// Largest number of entities that can be put in order.
inline constexpr std::size_t kMostOrdered = 20'000;

/// What keeps a list of entities from being an order of this drawing: one that is not in it, is not cut, is
/// named twice, or is forgotten. A sentence for each kind.
std::vector<std::string> orderFaults(const dieline::Dieline& dieline, const std::vector<int>& order);

/// What is doubtful in an order: entities within a closed cut that is cut through before them, so that they
/// lie on a piece that may have moved. A sentence for each such cut, the first hundred.
std::vector<std::string> orderDoubts(const dieline::Dieline& dieline, const std::vector<int>& order);

/// How entities in a given order are run.
enum class Senses {
  kNearest,  ///< In the sense, or begun at the place, that makes the air path between them shortest.
  kDrawn,
};

/// Entities in the order of job.given_order. With a kerf radius each has its part of the beam's path round
/// the whole outline, as in drawnOrder(). @pre orderFaults() has none.
std::vector<Stop> handOrder(const dieline::Dieline& dieline, const JobParameters& job,
                            const PlannerFaults& faults, Senses senses = Senses::kNearest);

}  // namespace kerfbench::planner
