// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "twin/five_axis/five_axis_description.h"

namespace kerfbench::fold {

/// Reads a five-axis program, strictly: a line is words of a letter and a number; G00 moves with the beam
/// off, G01 with it on; X Y Z in mm are the focus in the workpiece's frame, A and C in degrees. A line
/// without G goes on as the one before, an axis that is not named stays. The first move is a G00 that names
/// all five. Empty lines, a line's number (N), and comments in brackets or after ';' say nothing. Shares no
/// code with what writes such programs.
/// @throws base::InputError that lists every fault as "name:line: what": words that are none, other letters,
/// one twice, other G, numbers that are not finite or out of range (|X|, |Y|, |Z| <= 1e4 mm, |A| <= 360,
/// |C| <= 36000), a program without a cut.
std::vector<twin::FiveAxisMove> readFiveAxisProgram(const std::string& text, const std::string& name);

}  // namespace kerfbench::fold
