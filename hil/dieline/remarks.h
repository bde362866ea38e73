// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// What somebody has to know of a drawing that was read, at its place in the file.
struct Remark {
  int line{};  ///< From 1; 0: the file as a whole.
  bool
      is_warning{};  ///< Something of the drawing is not as its author may think: its size, what is left out.
  std::string message;  ///< One sentence, without file and line.
};

/// The unit, where the file does not say it, and what was left out of the drawing or mended, the first line
/// of each kind with it. Notes without a place are no warnings.
std::vector<Remark> remarksOf(const Dieline& dieline);

/// Name of a unit of this length: "mm", "cm", "in", "pt" or "px"; empty where there is none.
std::string nameOfUnit(double unit_mm);

}  // namespace kerfbench::dieline
