// SPDX-License-Identifier: Apache-2.0
#include "hil/app/record_frames_command.h"

#include "hil/app/run_guarded.h"
#include "hil/camera/v4l2/video_calls.h"

namespace kerfbench::app {

int recordFramesCommand(const live::RecordFramesOptions& options) {
  return runGuarded(options.scenario,
                    [&] { return live::recordFramesOf(camera::kernelVideoCalls(), options); });
}

}  // namespace kerfbench::app
