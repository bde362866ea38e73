// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <fmt/format.h>

#include "hil/inspect/verdict/verdict.h"

// Private to hil/inspect/checks.
namespace kerfbench::inspect::checks {

/// What the value of a check is that was decided by the worst of many readings (ExtremeEstimate): not that
/// reading, of which its sentence tells, but the middle between the least and the most that the worst may be.
/// Empty of a PASS, where both lie within the limit.
inline std::string intervalWords(const Check& check) {
  if (check.verdict == Verdict::kPass) return {};
  return fmt::format(
      " That is as it was read; with the uncertainty of every reading the worst is {:.3g} ± {:.2g} {}.",
      check.value, check.u, check.unit);
}

}  // namespace kerfbench::inspect::checks
