// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "hil/dieline/dxf_tags.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/notes.h"

namespace kerfbench::dieline {

/// A curve of a DXF entity in drawing units, and where it came from.
struct DxfCurve {
  Curve curve;
  std::string origin;
};

/// A valid entity that is no planar curve this reader takes: a fault, unless its layer is to be ignored.
class DxfUnsupported : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The curves of entity `index`, a POLYLINE with its VERTEX records behind it. Coordinates are in the world
/// frame of the drawing (or block): a downward extrusion direction is undone here. What is mended (a polyline
/// of one vertex is nothing, an ellipse may have its longer axis second) is noted.
/// @throws DxfUnsupported
std::vector<DxfCurve> dxfCurves(const std::vector<DxfRecord>& records, std::size_t index, FaultList& faults,
                                NoteList& notes);

/// -1 for an extrusion direction of (0, 0, -1), +1 for (0, 0, 1); the entity's x counts times this sign.
/// @throws DxfUnsupported for a tilted one.
double extrusionSign(const DxfRecord& record, FaultList& faults);

}  // namespace kerfbench::dieline
