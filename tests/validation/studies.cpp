// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/studies.h"

#include <array>

namespace kerfbench::validation {

std::span<const Study> studies() {
  static constexpr std::array kStudies{
      Study{"galvo-step", galvoStep},
      Study{"eight-joints", eightJoints},
      Study{"pulse-trains", pulseTrains},
      Study{"pull-out", pullOut},
      Study{"energy", energy},
      Study{"scan-formula", scanFormula},
      Study{"kerf-depth", kerfDepth},
      Study{"belt-friction", beltFriction},
      Study{"fast-mode", fastMode},
      Study{"jump-hook", jumpHook},
      Study{"mirror-stepper", mirrorStepper},
      Study{"strip", stripCutting},
      Study{"strip-return", stripReturn},
  };
  return kStudies;
}

}  // namespace kerfbench::validation
