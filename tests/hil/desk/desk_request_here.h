// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// The build whose firmware and reference pages the tests use.
inline const std::filesystem::path kBuild = KERFBENCH_BINARY_DIR;
inline const DeskRequest kRequest{.bin_dir = kBuild / "bin"};

}  // namespace kerfbench::desk
