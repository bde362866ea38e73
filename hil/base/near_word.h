// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::base {

/// The word that `typed` was probably meant to be: the nearest by letters that are missing, too many, wrong
/// or exchanged with their neighbour (Damerau 1964), of equally near ones the first. Empty if none is near:
/// more than a third of the letters would have to change, or two of a word of less than six. Capitals count
/// as small letters.
std::string nearWord(std::string_view typed, const std::vector<std::string>& words);

/// " Did you mean NEAR?" for the end of a message, or nothing.
std::string didYouMean(std::string_view typed, const std::vector<std::string>& words);

}  // namespace kerfbench::base
