// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Most faults that are listed for a contour or a path.
inline constexpr std::size_t kMostFaults = 20;

/// Side of a contour as seen along it.
enum class Side { kLeft, kRight };

/// A chain of lines and arcs of the drawing, and the side on which the beam runs.
struct Contour {
  std::vector<Segment> segments;
  Side side{Side::kLeft};
  bool closed{};
};

/// A contour that has no beam path, or none that could be proved; what() lists every reason with entity and
/// place.
class CompensationError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Names of entities: "E3", "E3 and E7", or the first four and how many more; "the contour" where there is no
/// number.
std::string entityNames(const std::vector<int>& entities);
/// Name of a place, e.g. "E3 at (1.000, 2.000)".
std::string placeName(const std::vector<int>& entities, const Eigen::Vector2d& p_mm);

/// Removes segments of no length and gaps at joints: ends are moved, a line goes between those that cannot
/// be. A full circle, and a contour that says so, is closed. @throws CompensationError if a number is not
/// finite, or an arc's radii differ or a joint gapes by more than `join_mm`.
Contour healed(Contour contour, double join_mm);

/// Describes all places where contours cross, touch or run back over themselves or each other: inside and
/// outside have no meaning there.
std::vector<std::string> contactFaults(const std::vector<Contour>& contours);

}  // namespace kerfbench::planner
