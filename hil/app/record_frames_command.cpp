// SPDX-License-Identifier: Apache-2.0
#include "hil/app/record_frames_command.h"

#include "hil/camera/v4l2/video_calls.h"
#include "hil/cli/run_guarded.h"

namespace kerfbench::app {

int recordFramesCommand(const live::RecordFramesOptions& options) {
  return cli::runGuarded(options.scenario,
                         [&] { return live::recordFramesOf(camera::kernelVideoCalls(), options); });
}

}  // namespace kerfbench::app
