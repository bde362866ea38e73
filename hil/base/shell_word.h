// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerfbench::base {

/// A word as it is typed into a shell (POSIX): as it is if a shell takes nothing of it for its own, else
/// between single quotes. Pasting it executes nothing. Where there are control characters, which a terminal
/// would obey while they are pasted, or bytes that are not UTF-8, printf makes the word.
std::string shellWord(std::string_view word);

}  // namespace kerfbench::base
