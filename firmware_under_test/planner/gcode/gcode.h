// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Writes pieces of path as text; a jump goes before each piece that does not begin where the one before
/// ended. `names` holds for each entity the word after its id in the comment.
std::string writeGcode(const std::vector<std::vector<Segment>>& pieces,
                       const std::vector<std::string>& names);
/// Writes pieces of path with a word for each entity; an empty word leaves it out.
std::string writeGcode(const std::vector<std::vector<Segment>>& pieces,
                       const std::function<std::string(int entity)>& name_of);

/// Reads the path of a G-code text, jumps included, from its first point to its last mark.
std::vector<Segment> readGcode(const std::string& text);

/// Path of a unit: from the first mark to the last. The machine itself jumps to its start.
std::vector<Segment> unitOf(std::vector<Segment> path);

}  // namespace kerfbench::planner
