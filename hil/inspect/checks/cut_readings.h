// SPDX-License-Identifier: Apache-2.0
#pragma once

// Between stillness.cpp and excursion.cpp. Private to hil/inspect.

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "hil/inspect/deviation/error_model.h"

namespace kerfbench::inspect::checks {

/// How the x-residuals of a cut may be wrong.
struct CutReadings {
  std::vector<double> sigma_mm;
  /// Makes frames x (modes of the camera, x and y of each registration mark): shift of the x-residual, mm.
  /// They are made when they are looked at: those of a long run would fill the memory.
  std::function<Eigen::MatrixXd()> shared;
  Eigen::Index columns{};  ///< Columns of shared().
};

/// What the place of a spot or a mark within its pixel does to the estimate of its centre, standard
/// deviation, mm. It does not average out: at a speed of a whole number of pixels per frame it is the same in
/// all of them. On strip-crosscut (200 mm/s, 0.2 mm pixels, 25 frames/s: 40 pixels) the offsets of six cuts
/// differ from what the kerf camera sees of the same by 0.2 … 1.8 um, 1.1 um RMS: 0.006 px.
double placeInPixelSigma_mm(const Evidence& evidence);

/// As a line of one unbroken run, for measureDeviations().
ReadingLine lineOf(const std::vector<double>& reading_mm, const std::vector<double>& sigma_mm,
                   const Eigen::MatrixXd& shared, double q);

}  // namespace kerfbench::inspect::checks
