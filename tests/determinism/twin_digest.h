// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "twin/description/fidelity.h"
#include "twin/description/imperfections.h"

namespace kerfbench::determinism {

/// Machines that together use every part of the twin.
enum class Machine { kMirrors, kMirrorsWithSteppers, kGantry, kGantryFed };
inline constexpr Machine kMachines[] = {Machine::kMirrors, Machine::kMirrorsWithSteppers, Machine::kGantry,
                                        Machine::kGantryFed};

struct TwinRun {
  Machine machine{Machine::kMirrors};
  twin::Fidelity fidelity{twin::Fidelity::kReference};
  twin::Preset preset{twin::Preset::kDynamic};
  std::uint64_t seed{1};
  double length_s{0.1};
};

/// Results of a run of the twin, each as a hash of every bit of every number.
struct Digest {
  std::uint64_t sheet{}, exposures{}, sensors{}, lost_steps{}, pose{};
  std::size_t burnt_bytes{}, exposure_count{}, edge_count{}, lost_count{};
  friend bool operator==(const Digest&, const Digest&) = default;
};

/// Cuts a small shape on a new machine.
Digest digestOf(const TwinRun& run);

std::string nameOf(const TwinRun& run);
/// Digest as one line, the same on every machine that computes the same.
std::string textOf(const Digest& digest);
/// Runs of all machines, in both fidelities, ideal and dynamic.
std::vector<TwinRun> allRuns();

}  // namespace kerfbench::determinism
