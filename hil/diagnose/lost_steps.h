// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/diagnose/known_causes.h"

namespace kerfbench::diagnose {

inline constexpr const char* kPulsesLost = "pulses_lost";
inline constexpr const char* kPulledOut = "stepper_pulled_out";
inline constexpr const char* kPulsesDoubled = "pulses_doubled";

/// An axis that is displaced from some time on, and what that means there.
struct LostSteps {
  Signature signature;  ///< Key with an '@' before the number of the time.
  KnownCause cause;
};

/// For both axes, between program and pulses and between pulses and beam, at each time at which it may have
/// happened: between two cuts, and within them. Of the pulses, those that go on in the way that the axis
/// moves then were doubled, the others lost.
std::vector<LostSteps> lostSteps(const Evidence& evidence, const std::vector<Row>& rows);

/// Pulses of one sense that get lost, or come twice, now and then through the whole run.
std::vector<KnownCause> leakingPulses(const Evidence& evidence);

}  // namespace kerfbench::diagnose
