// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "tests/validation/support/hand_eight.h"
#include "twin/machine/mechanism.h"

namespace kerfbench::validation {

/// Machine of eight joints composed of the twin's parts.
std::shared_ptr<const twin::Mechanism> twinEight(const EightJoints& machine);

/// Joints of the twin in the order of EightJoints.
EightJoints::Values jointsOf(std::span<const double> q);

/// Largest distances from the truth.
struct EightErrors {
  double spot_um{}, belt_um{}, gantry_um{};
  void add(const EightJoints::Values& truth, const EightJoints::Values& found);
};

}  // namespace kerfbench::validation
