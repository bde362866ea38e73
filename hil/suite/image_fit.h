// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/scenario/scenario.h"

namespace kerfbench::suite {

/// Why the image of a release cannot be that of a scenario's controller; empty: nothing speaks against it.
/// The emulator loads it, so that a file for another machine, or for more memory than there is, is refused.
/// An Intel HEX file does not say for which processor it is: the jump at the reset vector tells AVR and 8051
/// apart. `bin_dir`: where kerfbench's children are. Releases that the bench does not load itself (children
/// of others, real pins) are left to their runs, but for an analyser's, to which no image can be given.
std::string whyImageDoesNotFit(const scenario::FirmwareChoice& firmware,
                               const std::filesystem::path& bin_dir);

}  // namespace kerfbench::suite
