// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/diagnose/axes_fit.h"
#include "hil/dieline/geometry.h"
#include "twin/base/print_layout.h"

namespace kerfbench::diagnose {

/// Instants at which the head was on its way, by the pins alone.
struct GatedPath {
  std::vector<LitInstant> open;    ///< With the laser's gate open.
  std::vector<LitInstant> closed;  ///< With it closed.
};

/// Whether gate and cuts are complementary: with the gate closed the head is on the lines of the drawing
/// (four fifths of the instants within `near_mm`), with the gate open it is beside them (more than half). Not
/// said of fewer than 20 instants of either kind.
bool isGateInverted(const GatedPath& path, const PlaceOfSteps& place, const dieline::Dieline& dieline,
                    const PrintLayout& print, double near_mm);

}  // namespace kerfbench::diagnose
