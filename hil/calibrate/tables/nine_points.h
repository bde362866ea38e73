// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

/// Options of nine-point text (".fixup" of glase): nine lines "ix iy x_wrong_mm y_wrong_mm", in any order;
/// '#' begins a comment. (ix, iy), whole numbers within ±32, are places in steps of 1000 galvo units;
/// (x_wrong_mm, y_wrong_mm) is the error of the uncorrected point there, which is subtracted. Between the
/// points the table is Hermite's, which is the biquadratic surface that glase fits; outside there is none.
struct NinePointOptions {
  /// 2.5: glase's 400 units/mm. A line "# mm_per_index: …", which the writer puts in, is believed; one that
  /// contradicts this is a fault.
  std::optional<double> mm_per_index{};
};
inline constexpr double kGlaseMmPerIndex = 2.5;

/// The nine points that span the largest whole indices within the grid, or ±32 if `mm_per_index` is not
/// given: then one index is a 32nd of the least distance from (0, 0) to a side.
/// @throws std::invalid_argument if (0, 0) is not inside, or less than one index is.
std::string ninePointText(const AimGrid& grid, const NinePointOptions& options = {});

/// @throws TableFileError with every fault and its line. Lines with 'X' and 'Y' (points on the axes of a
/// mount,
///   an affine map and no part of a correction of the head) are refused, not passed over.
AimGrid parseNinePointText(const std::string& text, const std::string& name,
                           const NinePointOptions& options = {});

}  // namespace kerfbench::calibrate
