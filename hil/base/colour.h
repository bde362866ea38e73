// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

namespace kerfbench::base {

enum class ColourChoice { kAuto, kAlways, kNever };
enum class Colour { kGreen, kRed, kYellow, kMagenta, kBold };

/// What the user wants of this process; kAuto until it is called.
void chooseColour(ColourChoice choice);

/// Whether words to this stream are coloured: as chosen, else on a terminal that can, unless the environment
/// variable NO_COLOR is set and not empty (https://no-color.org).
bool isColoured(std::FILE* stream);

/// A line in which the verdicts (PASS, FAIL, INVALID, NOT PROVEN) have their colours, where the stream has
/// any.
std::string withVerdictsInColour(const std::string& line, std::FILE* stream);

/// The text in a colour, or as it is where the stream has none.
std::string inColour(const std::string& text, Colour colour, std::FILE* stream);

}  // namespace kerfbench::base
