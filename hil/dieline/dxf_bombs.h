// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/dieline/dxf_tags.h"
#include "hil/dieline/faults.h"

namespace kerfbench::dieline {

/// Copies that an INSERT makes of its block.
struct DxfArray {
  int columns{1};
  int rows{1};
};
DxfArray arrayOf(const DxfRecord& insert, FaultList& faults);

/// Counts what the INSERTs of a file unfold to, without unfolding: each block is looked at once.
/// @throws DielineError where blocks hold themselves, are nested deeper than kDeepestNesting, or unfold to
/// more than kMostEntities.
void refuseBombs(const DxfFile& file, FaultList& faults);

}  // namespace kerfbench::dieline
