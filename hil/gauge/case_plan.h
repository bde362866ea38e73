// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/gauge/kerf_case.h"
#include "hil/gauge/still_case.h"

namespace kerfbench::gauge {

/// Purpose of a case.
enum class Study {
  kBad,          ///< Faults of every kind in turn, true worst deviation 55 … 120 µm.
  kGood,         ///< Faults of every kind in turn, true worst deviation 0 … 40 µm.
  kCoverage,     ///< Faults of every size, and errors of a corner and an end.
  kRepeat,       ///< One artefact as it lies, with new noise.
  kRelay,        ///< One artefact, laid down elsewhere in the field each time.
  kGrr,          ///< Parts x placements x repeats.
  kStill,        ///< Drifts of every size.
  kStillRepeat,  ///< One run, new noise alone.
};
inline constexpr std::size_t kStudies = 8;
std::string_view studyName(Study study);  ///< "bad", "good", "coverage", …
inline bool watchesSpot(Study study) { return study == Study::kStill || study == Study::kStillRepeat; }

inline constexpr std::size_t kGrrParts = 10, kGrrPlacements = 3, kGrrRepeats = 3;
inline constexpr double kBadFrom_mm = 0.055, kBadTo_mm = 0.12, kGoodTo_mm = 0.040;

/// Case by its study, preset and number; its name repeats it with the same seed: "static-bad-17".
struct CaseId {
  twin::Preset preset{twin::Preset::kStatic};
  Study study{Study::kBad};
  std::size_t index{};
};
std::string nameOf(const CaseId& id);
std::optional<CaseId> caseFromName(std::string_view name);

/// Pure functions of their arguments: a case never depends on how many others there are.
KerfCase kerfCase(const CaseId& id, std::uint64_t seed, const KerfStudy& study);
StillCase stillCase(const CaseId& id, std::uint64_t seed);

}  // namespace kerfbench::gauge
