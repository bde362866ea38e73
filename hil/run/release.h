// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "hil/base/input_error.h"
#include "hil/scenario/scenario.h"
#include "hil/source/signal_source.h"

namespace kerfbench::run {

/// Starts a release in its emulator or as its own process. `bin_dir`: where kerfbench's children are.
/// @throws InputError that names the image.
std::unique_ptr<source::SignalSource> openRelease(const scenario::FirmwareChoice& firmware,
                                                  const std::filesystem::path& bin_dir);

}  // namespace kerfbench::run
