// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/base/console.h"
#include "hil/base/stopwatch.h"
#include "hil/judge/conclude.h"
#include "hil/live/real_pins.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"
#include "hil/trace/run/known_program.h"
#include "twin/description/imperfections.h"

namespace kerfbench::live {

/// Pins that were recorded, and the machine that they are given to.
struct PinsOfMachine {
  const twin::SampledMachine& sampled;
  const source::PinRecording& recorded;
  trace::KnownProgram program{};  ///< Shown in a trace.
};

/// Twin and judge behind pins that are recorded already. `conclusion` but for what the twin alone knows.
/// Returns the exit code of the verdict. Live or replayed, the recording is all there is.
int judgeRecorded(const scenario::Case& test_case, const PinsOfMachine& pins, judge::Conclusion conclusion,
                  const judge::RunOptions& options, base::Stopwatch& stopwatch, base::Console& console);

/// Runs a case on real pins and judges it. Whether the model runs along to drive the controller's inputs or
/// not, what is judged is the recording, with the model behind it: nothing that is slow there makes anything
/// late, and a replay of the recording is the same evidence. Returns the exit code of the verdict.
/// @throws InputError if the pins cannot be had (who, where, and what to do), and before that as
/// refuseKerfPictures(). Whatever is thrown behind the recording has passed salvageEvidence().
int runOnPins(const scenario::Case& test_case, const RealPins& pins, const judge::RunOptions& options,
              base::Stopwatch& stopwatch, base::Console& console);

}  // namespace kerfbench::live
