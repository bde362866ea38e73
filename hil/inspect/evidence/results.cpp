// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/results.h"

namespace kerfbench::inspect {

std::string_view jointName(JointResult::Kind kind) {
  switch (kind) {
    case JointResult::Kind::kCorner:
      return "corner";
    case JointResult::Kind::kRounding:
      return "rounding";
    case JointResult::Kind::kOvershoot:
      return "overshoot";
    case JointResult::Kind::kEndGap:
      return "end_gap";
    case JointResult::Kind::kClosure:
      break;
  }
  return "closure";
}

}  // namespace kerfbench::inspect
