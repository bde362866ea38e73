// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/observation.h"
#include "tests/hil/calibrate/head/simulated_head.h"

namespace kerfbench::calibrate::test {

/// Quality of the marks of a simulated calibration.
struct MarkQuality {
  double sigma_mm{0.0015};  ///< Standard deviation of the camera, per axis.
  double correlation{0.3};  ///< Correlation between both axes of one mark.
  double missing_share{};   ///< Share of the marks that are missing.
  double false_share{};  ///< Share of false marks, half exchanged with another mark, half 0.02 … 20 mm off.
};

/// Marks of one sheet: wanted places, aimed at by the table so far, and measured ones.
struct MarkedSheet {
  std::vector<AimedMark> aimed;
  std::vector<SeenMark> seen;
};

/// Makes n x n marks over the field, up to 0.1 mm off their rows, the first at `first_id`, with `fit`'s exact
/// correction, or without.
MarkedSheet mark(const SimulatedHead& head, int n, int first_id, const HeadFit* fit,
                 const MarkQuality& quality, std::uint64_t seed);

/// Largest and RMS error of 400 places that were never marked: anywhere, on the rim, in the table's cells.
struct Verification {
  double most_mm{}, rms_mm{};
  /// Number of places whose error without rounding lies in the predicted 95 % ellipse.
  std::size_t covered{};
  std::size_t places{};
  double largest_sigma_mm{};
};

struct CampaignResult {
  double raw_mm{};  ///< Largest error before the calibration.
  std::vector<Verification> iterations;
  std::size_t marks{}, rejected{};
  std::size_t refused{};  ///< Number of sheets of 3 x 3 from which no head could be fitted.
  double noise_ratio{};
  bool surface{};
  int nodes{};  ///< Nodes along a side of the last table.
};

/// Calibrates with 3 x 3, then 9 x 9, then 17 x 17 marks: each sheet made with the correction of the ones
/// before, all fitted together. Tables go to the planner as CSV and the planner interpolates them.
/// `unmodelled_share` is an input of the fit, by default the value of the data sheets.
CampaignResult calibrate(const SimulatedHead& head, const MarkQuality& quality, std::uint64_t seed,
                         std::optional<double> unmodelled_share = {});

}  // namespace kerfbench::calibrate::test
