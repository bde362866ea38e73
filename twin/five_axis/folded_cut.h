// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/five_axis/five_axis_description.h"
#include "twin/five_axis/folded_blank.h"
#include "twin/sheet/board_description.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// What a program has burnt.
struct FoldedCut {
  std::vector<Sheet> sheets;  ///< One for each face of the blank, in F.
  double cut_mm{};            ///< Way of the programmed focus with the beam on.
  double missed_mm{};         ///< The part of it along which the beam met no face.
};

/// Runs a program over a blank: each move straight in the places of the focus and in both angles, in steps
/// of no more than 0.04 mm or 0.2 degrees. Between two steps the footprint goes straight. The head is where
/// the first move leads, and what comes before it does not count. @throws std::invalid_argument for a
/// description that is out of range.
FoldedCut cutFolded(const FiveAxisDescription& head, const FoldedBlank& blank, const BoardDescription& board,
                    const std::vector<FiveAxisMove>& moves);

}  // namespace kerfbench::twin
