// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/conclude.h"
#include "hil/app/console.h"
#include "hil/app/real_pins.h"
#include "hil/app/stopwatch.h"
#include "hil/source/vcd.h"
#include "twin/cutter/imperfections.h"

namespace kerfbench::hil {

/// Twin and judge behind pins that are recorded already. `conclusion` but for what the twin alone knows.
/// Returns the exit code of the verdict. Live or replayed, the recording is all there is.
int judgeRecorded(const Case& the_case, const twin::DrawnMachine& drawn, const PinRecording& recorded,
                  Conclusion conclusion, const CommonOptions& options, Stopwatch& stopwatch,
                  Console& console);

/// Runs a case on real pins and judges it. Whether the model runs along to drive the controller's inputs or
/// not, what is judged is the recording, with the model behind it: nothing that is slow there makes anything
/// late, and a replay of the recording is the same evidence. Returns the exit code of the verdict.
/// @throws InputFault if the pins cannot be had (who, where, and what to do), and before that as
/// refuseKerfPictures(). Whatever is thrown behind the recording has passed keepEvidence().
int runOnPins(const Case& the_case, const RealPins& pins, const CommonOptions& options, Stopwatch& stopwatch,
              Console& console);

}  // namespace kerfbench::hil
