// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/guest/film.h"

namespace kerfbench::guest {

/// Film of recorded pins by the twin's spot camera, each picture at its time on the clock of the pins.
Film filmOf(const std::filesystem::path& scenario, const std::filesystem::path& pins);

}  // namespace kerfbench::guest
