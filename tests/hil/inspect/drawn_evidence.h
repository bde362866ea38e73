// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hil/inspect/checks/spot_checks.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect::testing {

/// Evidence sampled from the error model about a truth that is known: every seed has another shape and size
/// of fault, another noise, correlation, pose and calibration error.
struct DrawnEvidence {
  explicit DrawnEvidence(std::uint64_t seed);

  SyntheticRun run;
  LitFrames lit;

  // Truth of the evidence.
  double worst_mm{};  ///< Largest deviation of all lines, away from joints.
  double rms_mm{};
  std::vector<double> entity_worst_mm;  ///< Largest deviations in the order of the scan.
  std::vector<double> entity_width_mm;  ///< Mean widths in the order of the scan.
  std::vector<double> drift_mm;         ///< Drift of each cut.
  double worst_drift_mm{};
};

/// Number of stated intervals that contain the truth, over seeds first … first + cases - 1.
struct Coverage {
  struct Count {
    int inside{};
    int cases{};
    [[nodiscard]] double share() const { return static_cast<double>(inside) / cases; }
    void add(const Quantity& stated, double truth);
  };
  Count worst, entity_worst, rms, width, drift, worst_drift;
  int wrong_pass{};  ///< Number of cases with PASS though the worst is 0.055 mm or more.
  int wrong_fail{};  ///< Number of cases with FAIL though it is 0.040 mm or less.
  int good{}, bad{}, unproven_good{};
  std::vector<double> budget_ratio;  ///< Ratio of U by the budget to U by simulation, of the worst deviation.
  double largest_U_mm{};
};
Coverage measureCoverage(std::uint64_t first, int cases);

}  // namespace kerfbench::inspect::testing
