// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/app/show_command.h"
#include "hil/scene/picture.h"

namespace kerfbench::app {

/// As a command line has it.
scene::PictureOptions pictureOptions(const ShowOptions& options);

/// Makes a film: of a trace (SUBJECT), or of a run of a scenario (--scenario, or SUBJECT). Returns 0,
/// base::kExitUsage, or base::kExitBroken without FFmpeg. @throws what showCommand() catches.
int showFilm(const ShowOptions& options);

}  // namespace kerfbench::app
