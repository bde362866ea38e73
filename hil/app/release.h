// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>

#include "hil/app/scenario.h"
#include "hil/source/signal_source.h"

namespace kerfbench::hil {

/// A release image or a recording that cannot be used.
struct InputFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Starts a release in its emulator or as its own process. `bin_dir`: where kerfbench's children are.
/// @throws InputFault that names the image.
std::unique_ptr<SignalSource> openRelease(const FirmwareChoice& firmware,
                                          const std::filesystem::path& bin_dir);

}  // namespace kerfbench::hil
