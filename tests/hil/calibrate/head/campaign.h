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

/// How the marks of a simulated calibration come out.
struct MarkQuality {
  double sigma_mm{0.0015};  ///< Of the camera, per axis.
  double correlation{0.3};  ///< Between both axes of one mark.
  double missing_share{};   ///< Of the marks.
  double false_share{};     ///< Half exchanged with another mark, half 0.02 … 20 mm off.
};

/// Marks of one sheet: what was wanted, aimed at by the table so far, measured.
struct MarkedSheet {
  std::vector<AimedMark> aimed;
  std::vector<SeenMark> seen;
};

/// n x n marks over the field, up to 0.1 mm off their rows, the first at `first_id`, made with `fit`'s exact
/// correction, or without.
MarkedSheet mark(const SimulatedHead& head, int n, int first_id, const HeadFit* fit,
                 const MarkQuality& quality, std::uint64_t seed);

/// Largest and RMS error of 400 places that were never marked: anywhere, on the rim, in the table's cells.
struct Verification {
  double most_mm{}, rms_mm{};
  std::size_t covered{};  ///< Whose error without rounding lies in the predicted 95 % ellipse.
  std::size_t places{};
  double largest_sigma_mm{};
};

struct CampaignResult {
  double raw_mm{};  ///< Largest error before.
  std::vector<Verification> iterations;
  std::size_t marks{}, rejected{};
  std::size_t refused{};  ///< Sheets of 3 x 3 from which no head could be fitted.
  double noise_ratio{};
  bool surface{};
  int nodes{};  ///< Of the last table's side.
};

/// 3 x 3, then 9 x 9, then 17 x 17: each sheet made with what the ones before gave, all fitted together.
/// Tables go to the planner as CSV and the planner interpolates them. `unmodelled_share` is what the fit is
/// told, by default what the data sheets say.
CampaignResult calibrate(const SimulatedHead& head, const MarkQuality& quality, std::uint64_t seed,
                         std::optional<double> unmodelled_share = {});

}  // namespace kerfbench::calibrate::test
