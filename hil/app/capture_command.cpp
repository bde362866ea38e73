// SPDX-License-Identifier: Apache-2.0
#include "hil/app/capture_command.h"

#include "hil/cli/run_guarded.h"

namespace kerfbench::app {

int captureCommand(const live::CaptureOptions& options) {
  return cli::runGuarded(options.scenario,
                         [&] { return live::captureOnPins(live::realPins(options.bin_dir), options); });
}

}  // namespace kerfbench::app
