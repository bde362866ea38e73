// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/inspect/inspect.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// Sensors that this job moves and whose edges the recording lacks, one sentence each: the encoder of a web
/// that moves, and the eye mark of each unit that passes its sensor before the last cut ends. A sensor that
/// is not wired is not missed, nor one of a web that the controller feeds. `pins` holds gates and belt of the
/// recording.
std::vector<std::string> missingSensors(const scenario::Case& test_case,
                                        const source::PinRecording& recording, const inspect::Evidence& pins);

}  // namespace kerfbench::judge
