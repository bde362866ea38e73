// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of inspect() that rest on the spot camera. Private to hil/inspect and its tests.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/results.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/verdict/tolerances.h"

namespace kerfbench::inspect::checks {

/// "unit 2, E14"; "unit 2, along no drawn line at x 12.30, y 45.60 mm" of a spot that is on none.
std::string nameOf(const LitFrame& frame);

/// Stillness of each run of lit frames, and of the worst.
struct Stillness {
  std::vector<CutResult> cuts;
  Quantity worst_drift_mm;  ///< Magnitude; NaN if no cut shows x.
  std::size_t worst_cut{};
  double chance_beyond{std::numeric_limits<double>::quiet_NaN()};
  UncertaintyBudget budget;
  Quantity worst_excursion_mm;  ///< NaN if no cut shows x.
  std::size_t worst_excursion_cut{};
  double excursion_chance_beyond{std::numeric_limits<double>::quiet_NaN()};
};
Stillness measureCuts(const Evidence& evidence, const LitFrames& lit, const Tolerances& limits);
/// Fills top_speed_mm_s of a cut and its uncertainty.
void measureTopSpeed(const LitFrames& lit, const LitRun& run, CutResult& cut);
struct CutReadings;
/// Offset and excursion of each cut, and the worst excursion. `q`: correlation of neighbouring frames' noise.
void measureExcursions(const Evidence& evidence, const std::vector<CutReadings>& readings, double q,
                       double limit_mm, Stillness& stillness);
/// The frame of a cut whose residual lies farthest from `from_mm`. The cut has frames.
Whereabouts farthestFrame(const CutResult& cut, double from_mm);
/// Fills EntityResult::passes.
void countPasses(const Evidence& evidence, const LitFrames& lit, std::vector<EntityResult>& entities);
/// Frames that never arrived.
struct FrameLosses {
  std::uint64_t around_cuts{};   ///< INVALID. Those that the sequence does not show count as such.
  std::uint64_t between_cuts{};  ///< The gate was off, by the pins, for a frame before and after: no harm.
  std::uint64_t out_of_order{};
  std::uint64_t first{};  ///< Sequence number of the first around a cut.
};
FrameLosses lossesOf(const Evidence& evidence);
/// Frames lost around cuts, stamps that fit neither the sequence nor the sheet's motion, a camera that did
/// not watch all cuts.
std::vector<std::string> frameProblems(const Evidence& evidence);
std::vector<std::string> spotProblems(const Evidence& evidence, const LitFrames& lit);

/// Readings outside of what the calibrations cover. They spoil a measured value; that a line is not there, or
/// that something is burnt elsewhere, they do not.
std::vector<std::string> doubtsOf(const Evidence& evidence, const LitFrames& lit, const Tolerances& limits);

Check stillnessCheck(const Tolerances& limits, const LitFrames& lit, const Stillness& stillness);
/// Largest distance from the mean place on the sheet, of all cuts that show x.
Finding excursionCheck(const Tolerances& limits, const Stillness& stillness);
/// The sheet's way over each cut by the pictures against that by the belt's encoder: INVALID where they part
/// by more than the limit of stillness, for one of them is wrong. Not applicable where the belt stood; not
/// judged with an encoder too coarse to tell.
Finding beltCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit);
/// Frames that should show a spot and do not, as a share: INVALID beyond one in a thousand, or two in a row.
Check spotSeenCheck(const Evidence& evidence, const LitFrames& lit);
/// True when the spot is away from every line in more than nine of ten frames: then those few that lie near
/// one do so by chance, and tell neither stillness nor passes.
bool isBesideEveryLine(const LitFrames& lit);
Check spotPathCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit);
Check repeatCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit,
                  const std::vector<EntityResult>& entities);

/// Light of the laser, by the pins, that falls on one place of the sheet, by the spot camera: as much as how
/// long a piece of the job's own cuts gets. A beam that rests with the laser on burns a hole there.
Finding dwellCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit);

/// Gate against the spot's own motion; not judged if no start could be fitted.
Finding gateLagCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit);

}  // namespace kerfbench::inspect::checks
