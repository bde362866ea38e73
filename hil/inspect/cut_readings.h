// SPDX-License-Identifier: Apache-2.0
#pragma once

// Between stillness.cpp and excursion.cpp. Private to hil/inspect.

#include <vector>

#include <Eigen/Core>

#include "hil/inspect/error_model.h"

namespace kerfbench::hil::checks {

/// How the x-residuals of a cut may be wrong.
struct CutReadings {
  std::vector<double> sigma_mm;
  Eigen::MatrixXd shared;  ///< Frames x modes of the camera: shift of the x-residual, mm.
};

/// As a line of one unbroken run, for measureDeviations().
ReadingLine lineOf(const std::vector<double>& reading_mm, const std::vector<double>& sigma_mm,
                   const Eigen::MatrixXd& shared, double q);

}  // namespace kerfbench::hil::checks
