// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace kerfbench::planner {

/// Ranges of entities by id, first and last included.
using EntityRanges = std::vector<std::pair<int, int>>;

/// Whether an id is in one of the ranges.
bool contains(const EntityRanges& ranges, int entity);

/// Items of a list that is separated by commas, without the blanks around them; none of an empty text.
std::vector<std::string_view> itemsOf(std::string_view list);

/// Ids of ranges one by one, in the order of the ranges. @throws PlanError if they are more than `most`.
std::vector<int> idsOf(const EntityRanges& ranges, std::size_t most);

/// Parses entities as typed: "3,E5-8". `name` is what the user calls the list. @throws PlanError with
/// everything wrong.
EntityRanges entityRangesFrom(std::string_view list, std::string_view name);

}  // namespace kerfbench::planner
