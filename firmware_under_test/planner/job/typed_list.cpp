// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/job/typed_list.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/text.h"

namespace kerfbench::planner {
namespace {

std::optional<int> idOf(std::string_view text) {
  text = base::trimmed(text);
  if (!text.empty() && (text.front() == 'E' || text.front() == 'e')) text.remove_prefix(1);
  int id = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size() || id < 0) return std::nullopt;
  return id;
}

}  // namespace

bool contains(const EntityRanges& ranges, int entity) {
  return std::ranges::any_of(ranges, [&](const auto& r) { return entity >= r.first && entity <= r.second; });
}

std::vector<std::string_view> itemsOf(std::string_view list) {
  std::vector<std::string_view> items;
  if (base::trimmed(list).empty()) return items;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t to = std::min(list.find(',', from), list.size());
    items.push_back(base::trimmed(list.substr(from, to - from)));
    from = to + 1;
  }
  return items;
}

std::vector<int> idsOf(const EntityRanges& ranges, std::size_t most) {
  std::vector<int> ids;
  for (const auto& [first, last] : ranges) {
    if (static_cast<std::size_t>(last - first) >= most - std::min(ids.size(), most))
      throw PlanError(fmt::format("more than {} entities", most));
    for (int id = first; id <= last; ++id) ids.push_back(id);
  }
  return ids;
}

EntityRanges entityRangesFrom(std::string_view list, std::string_view name) {
  EntityRanges ranges;
  std::vector<std::string> faults;
  for (const std::string_view item : itemsOf(list)) {
    const std::size_t dash = item.find('-');
    const auto first = idOf(item.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : idOf(item.substr(dash + 1));
    if (!first || !last) {
      faults.push_back(fmt::format("{}: '{}' is neither an id nor a range such as 5-8", name, item));
    } else if (*last < *first) {
      faults.push_back(fmt::format("{}: '{}' ends before it begins", name, item));
    } else {
      ranges.emplace_back(*first, *last);
    }
  }
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
  return ranges;
}

}  // namespace kerfbench::planner
