// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "hil/inspect/inspect.h"
#include "hil/report/run_report.h"
#include "twin/camera/camera.h"

namespace kerfbench::judge {

/// Where the spot that a real camera measured parts from that of the model that ran along with the same pins,
/// cut by cut, in the frame of the machine. For people: nothing of it is judged. `exposures` of the model by
/// time and much denser than the camera's; frames beside them, dark ones of either included, are left out.
std::vector<report::SpotParting> spotPartings(const vision::SpotTrack& track,
                                              std::span<const twin::Exposure> exposures,
                                              const std::vector<inspect::CutResult>& cuts);

}  // namespace kerfbench::judge
