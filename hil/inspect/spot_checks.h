// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of inspect() that rest on the spot camera. Private to hil/inspect and its tests.

#include <optional>
#include <vector>

#include "hil/inspect/inspect.h"
#include "hil/inspect/spot_association.h"

namespace kerfbench::hil::checks {

/// Stillness of each run of lit frames.
std::vector<CutResult> measureCuts(const Evidence& evidence, const LitFrames& lit);
/// Fills EntityResult::passes.
void countPasses(const Evidence& evidence, const LitFrames& lit, std::vector<EntityResult>& entities);
std::vector<std::string> spotProblems(const Evidence& evidence, const LitFrames& lit);

Check stillnessCheck(const Limits& limits, const LitFrames& lit, const std::vector<CutResult>& cuts);
Check spotPathCheck(const Evidence& evidence, const Limits& limits, const LitFrames& lit);
Check repeatCheck(const Evidence& evidence, const Limits& limits, const LitFrames& lit,
                  const std::vector<EntityResult>& entities);

/// Gate against the spot's own motion; nullopt if the camera is too slow to see a start.
std::optional<Check> gateLagCheck(const Evidence& evidence, const Limits& limits, const LitFrames& lit);

}  // namespace kerfbench::hil::checks
