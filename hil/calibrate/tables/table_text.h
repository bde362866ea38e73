// SPDX-License-Identifier: Apache-2.0
#pragma once

// Helpers of the readers of text; for use inside of this folder.
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/text.h"
#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

/// A node as a line of text gives it: x, y, and the two numbers of its correction.
struct TextNode {
  std::size_t line{};
  std::array<double, 4> value{};
};

/// Calls `take(number, line)` for each line, from 1 on, without blanks at its ends; empty ones too.
void forEachLine(std::string_view text, const std::function<void(std::size_t, std::string_view)>& take);

using base::trimmed;

/// Words between separators: any of `separators`, and blanks. Two commas in a row enclose an empty word.
std::vector<std::string_view> wordsOf(std::string_view line, char separator = ' ');

/// The number that the whole word is, in ±bound; a fault and false if it is none.
bool numberOf(std::string_view word, double bound, std::size_t line, TableFaults& faults, double& value);

/// Adds the node of four numbers: places to ±100 m, values to ±10 m. A fault in its place if they are none,
/// and for the first node beyond what a grid may have.
void addNode(const std::vector<std::string_view>& words, std::size_t line, TableFaults& faults,
             std::vector<TextNode>& nodes);

/// "nodes: 7 x 5": a note that tells a smaller file from one that was cut off.
std::string nodesNote(const AimGrid& grid);

/// The complete grid of these nodes, in any order; values as given. Missing and doubled nodes are faults;
/// and if `text`, the whole file, has the note in a comment, another number of nodes or an end without a
/// newline.
/// @throws TableFileError with all faults so far.
AimGrid gridOf(std::string_view text, const std::vector<TextNode>& nodes, TableFaults& faults,
               Between between, Outside outside);

}  // namespace kerfbench::calibrate
