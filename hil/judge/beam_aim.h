// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/scenario/case.h"
#include "hil/source/vcd.h"
#include "hil/vision/spot/spot_track.h"

namespace kerfbench::judge {

/// Where the spot camera is to look: the steps that the pins have asked for, by what the controller was told
/// of its head. Empty, so that the camera is read out whole, if its machine file tells no read-out or an axis
/// is not wired.
vision::BeamAim beamAim(const scenario::Case& test_case, const source::PinRecording& recording);

}  // namespace kerfbench::judge
