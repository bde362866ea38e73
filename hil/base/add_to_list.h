// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerfbench::base {

/// Appends one more sentence to a text: on a line of its own, or behind another separator.
inline void addToList(std::string& list, std::string_view item, std::string_view separator = "\n") {
  if (!list.empty()) list += separator;
  list += item;
}

}  // namespace kerfbench::base
