// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "hil/dieline/geometry.h"
#include "twin/base/print_layout.h"

namespace kerfbench::gauge {

/// Faults of a cut.
enum class FaultKind {
  kOffset,    ///< All of it is shifted.
  kBump,      ///< One line leaves its path over a short stretch and comes back.
  kCorner,    ///< A corner is rounded (size > 0) or run over (size < 0).
  kEnd,       ///< A line ends too early (size > 0) or too late (size < 0).
  kScale,     ///< All of it is too large or too small, about the middle.
  kRotation,  ///< All of it is turned about the middle.
  kWave,      ///< Every line sways about its path.
  kEntity,    ///< One line is shifted.
};
inline constexpr std::array kFaultKinds{FaultKind::kOffset, FaultKind::kBump,  FaultKind::kCorner,
                                        FaultKind::kEnd,    FaultKind::kScale, FaultKind::kRotation,
                                        FaultKind::kWave,   FaultKind::kEntity};
std::string_view faultName(FaultKind kind);  ///< "offset", "bump", …

/// A fault of a size, the rest of its shape sampled. Lengths in mm; `size_mm` is about the worst deviation
/// that it makes.
struct Fault {
  FaultKind kind{FaultKind::kOffset};
  double size_mm{};
  double direction_rad{};  ///< Direction for kOffset, and for kEntity where the entity is bent.
  int entity{};            ///< Entity for kBump, kEnd, kEntity.
  double place{0.5};       ///< Place for kBump: middle along the entity, 0 … 1.
  double length_mm{1.0};   ///< Length: for kBump the standard deviation, for kWave about one wave.
  double phase_rad{};      ///< Phase for kWave.
  bool at_start{};         ///< End for kEnd: the start of the entity, or its end.
};

/// The work piece that gauge cuts: 21 x 16 mm within four printed marks, so that one picture shows all of it
/// anywhere in the kerf camera's field. Lines in four directions, an arc, a circle, a corner, free ends, a
/// crease; nothing is nearer to anything else than 1.5 mm, so what a line is judged by is its own kerf.
struct Artefact {
  dieline::Dieline dieline;
  PrintLayout print;
  int circle{};                   ///< Entity ids.
  int corner_in{}, corner_out{};  ///< The first ends where the second begins.
};
/// Turn of the beam at its corner, degrees.
enum class CornerAngle : std::size_t { k30, k60, k90, k120, k150 };
inline constexpr std::array kCornerAngles{CornerAngle::k30, CornerAngle::k60, CornerAngle::k90,
                                          CornerAngle::k120, CornerAngle::k150};
const Artefact& gaugeArtefact(CornerAngle corner = CornerAngle::k90);

/// A fault whose shape is sampled from a stream of `seed`, with the size given. Of kBump and kEntity the
/// entity is one that is cut through and does not meet another.
Fault drawFault(FaultKind kind, double size_mm, const Artefact& artefact, std::uint64_t seed);

}  // namespace kerfbench::gauge
