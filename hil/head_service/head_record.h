// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "hil/calibrate/head/observation.h"
#include "hil/head_service/head_setup.h"

namespace kerfbench::head_service {

/// Record of a calibration: the marks from which its best table was made.
struct HeadRecord {
  std::vector<calibrate::HeadObservation> observations;
  int iterations{};             ///< Number of iterations whose grids these are.
  double unmodelled_share{};    ///< Share that the calibration was configured with.
  std::filesystem::path table;  ///< Table that was made of the observations.
};

/// Reads the results of `calibrate head`, on the twin or by hand: head.json and the sheets of the grids.
/// @throws ConfigError with everything that is wrong: files that are missing, of another machine, or made
/// from
///   pictures alone, which keep no sheets; a calibration that was not good.
HeadRecord readHeadRecord(const std::filesystem::path& results, const HeadSetup& setup);

}  // namespace kerfbench::head_service
