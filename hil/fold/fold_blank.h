// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/inspect/space/space_job.h"
#include "twin/five_axis/folded_blank.h"

namespace kerfbench::fold {

/// A blank as it is drawn, and as it stands on the model.
struct FoldBlank {
  std::vector<inspect::SpaceFace> drawn;
  std::vector<twin::BlankFace> standing;
};

/// Reads the list `faces` of a scenario. The first face lies where `origin_mm`, `x_axis` and `normal` say,
/// with `outline_mm` (least x, least y, largest x, largest y). Each other one is folded on one before it
/// (`fold_on`) along the line `fold_mm` (x y x y in that face's frame), by `fold_deg` away from the normal's
/// side (> 0: an edge that sticks out towards the head); its own frame has its origin in the first point, x
/// along the line, y away from the other face, and it reaches from the line to `depth_mm`. `fold_error_deg`
/// is added to how it stands. All faults go to the reader.
FoldBlank readBlank(base::YamlReader& file);

/// Moves each printed mark of the standing blank by what the plate is off.
void misprint(double sigma_mm, std::uint64_t seed, FoldBlank& blank);

}  // namespace kerfbench::fold
