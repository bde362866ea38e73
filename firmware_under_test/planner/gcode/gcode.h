// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Pieces of path to text; a jump goes before each piece that does not begin where the one before ended.
/// `names` holds for each entity the word after its id in the comment.
std::string writeGcode(const std::vector<std::vector<Segment>>& pieces,
                       const std::vector<std::string>& names);
/// The same with the word of each entity asked for; an empty one leaves it out.
std::string writeGcode(const std::vector<std::vector<Segment>>& pieces,
                       const std::function<std::string(int entity)>& name_of);

/// What a G-code text says, jumps included, from its first point to its last mark.
///
/// Accepted: upper and lower case, blanks anywhere, comments in () and after ';', '%', N words, the headings,
/// modal G, X, Y and Z left out, G21 and G90, M02 and M30. The Z of marks is modal among marks only: a jump
/// does not clear it, so that a deleted Z word does not leave a cut out in silence.
/// @throws PlanError that lists every fault with its line.
std::vector<Segment> readGcode(const std::string& text);

/// What a unit is of such a path: from the first mark to the last. The machine jumps to its start by itself.
std::vector<Segment> unitOf(std::vector<Segment> path);

}  // namespace kerfbench::planner
