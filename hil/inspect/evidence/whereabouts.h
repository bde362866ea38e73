// SPDX-License-Identifier: Apache-2.0
#pragma once

// Where and when the worst value of a check was found, for people who look there. No verdict depends on it.

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::inspect {

/// A line that is judged as a whole.
Whereabouts onLine(int unit, int entity);
/// A place on the sheet of a unit, S; `entity` < 0: on no line.
Whereabouts atPlace(int unit, int entity, const Eigen::Vector2d& p_S_mm);
/// A frame of the spot camera, and where the spot was.
Whereabouts inFrame(const LitFrame& frame);
/// A time of the pins.
Whereabouts atTime(double time_s);

/// Adds what the spot camera's frames tell: the place of the spot at a time that is known, or the time at
/// which the spot passed a place that is known, between the two frames on either side of it. A line that is
/// judged as a whole gets its middle. The spot passed a place if it came within kReach_mm of it while it
/// followed the line of that place, or else within kSearch_mm; where it came near more than once, the
/// nearest counts. What no frame tells stays unknown.
void complete(Whereabouts& where, const LitFrames& lit, const dieline::Dieline& dieline);

}  // namespace kerfbench::inspect
