// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/gauge/instrument.h"
#include "hil/gauge/quantity.h"
#include "twin/camera/camera.h"

namespace kerfbench::gauge {

/// Three cuts of 12 mm across a running web, watched by the spot camera, the beam at rest on the web along x
/// but for the faults here. All is sampled from seeds.
///
/// What a preset changes: static, how askew the web runs (2 mrad) and by how much the encoder's scale makes
/// the beam outrun it; dynamic, also the encoder's run-out and the board's flutter, which move the beam on
/// the web. The truth has all of that.
struct StillCase {
  std::string name;
  twin::Preset preset{twin::Preset::kStatic};
  struct Cut {
    double drift_mm{};   ///< Interval from the first to the last instant of the cut.
    double offset_mm{};  ///< Offset of its middle.
    double sway_mm{};    ///< Amplitude of a sine of 1 … 3 waves.
  };
  std::vector<Cut> cuts;  ///< Three.
  double speed_mm_s{60.0};
  std::uint64_t machine_seed{};
  std::uint64_t place_seed{};  ///< Place in the camera's field, and pose of the web.
  std::uint64_t board_seed{};
  std::uint64_t noise_seed{};
};

struct StillOutcome {
  std::string name;
  double truth_mm{};                                     ///< Largest drift of the three.
  inspect::Verdict verdict{inspect::Verdict::kInvalid};  ///< Verdict of the stillness check.
  std::vector<Reading> readings;
  double analytic_U_mm{}, monte_carlo_U_mm{};  ///< U of the largest drift, by budget and by Monte Carlo.
  std::vector<std::string> problems;
};

/// Drift is that of the least-squares line through the true x-residuals at the middles of the frames that
/// inspection judges the cut by; peak, excursion and RMS are of the same residuals, the last two about their
/// mean.
class StillStudy {
 public:
  /// `setup` must outlive this.
  explicit StillStudy(const GaugeSetup& setup);
  [[nodiscard]] StillOutcome run(const StillCase& test_case) const;

 private:
  class Web;
  [[nodiscard]] std::vector<twin::Exposure> watch(const StillCase& test_case, const Web& web) const;

  const GaugeSetup& setup_;
  dieline::Dieline dieline_;
  PrintLayout print_;
};

}  // namespace kerfbench::gauge
