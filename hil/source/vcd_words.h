// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kerfbench::source {

/// A sentence as a comment of a VCD file carries it: readable, and without what would end the comment or get
/// lost in it (%XX for '$', '%', control characters, and blanks next to another or at an end).
std::string vcdWords(std::string_view text);

/// Back; nullopt: no such words.
std::optional<std::string> fromVcdWords(std::string_view words);

}  // namespace kerfbench::source
