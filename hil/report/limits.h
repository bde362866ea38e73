// SPDX-License-Identifier: Apache-2.0
#pragma once

// The limits of a scenario by the names of their keys. Private to hil/report.

#include <string_view>
#include <vector>

#include "hil/inspect/inspect.h"

namespace kerfbench::report {

/// A limit that a scenario may set; the larger, the more a cut may be off.
struct NamedLimit {
  std::string_view key;
  std::string_view unit;  ///< Empty: a share.
  double value{};
  double usual{};  ///< The default, in the same unit.
};
std::vector<NamedLimit> namedLimits(const inspect::Tolerances& limits);

}  // namespace kerfbench::report
