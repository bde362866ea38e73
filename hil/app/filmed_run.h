// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "hil/base/console.h"
#include "hil/run/machine_film.h"
#include "hil/scenario/case.h"

namespace kerfbench::app {

/// Runs a case by the fast twin to its end or to a time, without judging it, and tells where machine and beam
/// were. What goes wrong in the run is told on standard error.
run::MachineFilm filmedRun(const scenario::Case& test_case, const twin::SampledMachine& sampled,
                           std::optional<double> until_s, const std::filesystem::path& bin_dir,
                           base::Console& console);

}  // namespace kerfbench::app
