// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hil/dieline/file_format.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/witness/second_reading.h"

namespace kerfbench::witness {

/// How far two readings of one drawing may part. A coordinate that was read twice differs by its rounding
/// alone: in a double 2^-53 of itself, in MuPDF's single precision 2^-24.
struct Tolerance {
  double box_mm{1e-3};
  double length_mm{1e-3};
  double length_share{1e-9};  ///< Share of the length: quadrature, and sums of very many lines.
  /// For each line, of the drawing's extent: the rounding of its ends. Such errors are independent, so that
  /// those of n lines add up to that of sqrt(n).
  double line_share{};

  /// Limit for a layer of so many lines in a drawing of this extent.
  [[nodiscard]] double lengthLimit_mm(double length_mm_, std::size_t lines, double extent_mm) const;
};
Tolerance toleranceFor(dieline::FileFormat format);

/// What the comparison of two readings came to.
struct Comparison {
  std::vector<std::string> partings;  ///< Where the readings part, one sentence each; empty: they agree.
  std::size_t layers{};               ///< Pairs of layer and process that were compared.
  double length_mm{};                 ///< Sum of our lengths.
  double worst_length_mm{};           ///< Largest difference of a layer's length.
  double worst_box_mm{};              ///< Largest difference of a side of a layer's box.
};

/// Compares lengths and boxes of each layer and process. The second reader knows no processes: our rules for
/// layers, colours and linetypes are applied to what it found. What a rule ignores is not compared, but in a
/// PDF, where layers alone are compared and those that only we know by name (processing steps) as a whole.
/// `dieline` was read by `options`; what a selection leaves out counts as if it were selected.
Comparison compareReadings(const dieline::Dieline& dieline, const SecondReading& second,
                           const dieline::DrawingOptions& options, dieline::FileFormat format);

}  // namespace kerfbench::witness
