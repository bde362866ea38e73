// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/gauge/cut.h"
#include "hil/gauge/instrument.h"
#include "hil/gauge/quantity.h"
#include "twin/base/image.h"

namespace kerfbench::gauge {

/// Artefact to be cut, sampled from seeds.
struct KerfCase {
  std::string name;  ///< "static-bad-17"
  twin::Preset preset{twin::Preset::kStatic};
  std::vector<Fault> faults;
  std::uint64_t
      machine_seed{};  ///< Seed of the machine that the preset samples, and of where in its field it cuts.
  std::uint64_t place_seed{};  ///< Pose under the camera.
  std::uint64_t board_seed{};  ///< Number of the piece of board.
  std::uint64_t noise_seed{};  ///< Seed of the camera's noise.
  std::uint64_t world_seed{};  ///< Seed of the world, with GaugeSetup::mismatch.
};

/// Error of one caliper at its place in the camera's field.
struct FieldError {
  Eigen::Vector2d p_V_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d normal{Eigen::Vector2d::UnitX()};  ///< Unit normal in V.
  double error_mm{};                                 ///< Along the normal.
};

struct KerfOutcome {
  std::string name;
  FaultKind kind{};   ///< Kind of the first fault.
  double size_mm{};   ///< Size of the first fault.
  double truth_mm{};  ///< Worst deviation of lines, corner and ends.
  inspect::Verdict verdict{inspect::Verdict::kInvalid};
  inspect::Verdict path_verdict{inspect::Verdict::kInvalid};  ///< Verdict of the path check alone.
  std::vector<Reading> readings;
  double worst_as_read_mm{};
  double analytic_U_mm{}, monte_carlo_U_mm{};  ///< U of the worst of all lines, by budget and by Monte Carlo.
  std::vector<FieldError> field;               ///< Every eighth caliper.
  std::vector<std::string> problems;
};

/// Cuts, looks and measures. Pure.
class KerfStudy {
 public:
  /// `setup` must outlive this.
  explicit KerfStudy(const GaugeSetup& setup);
  [[nodiscard]] KerfOutcome run(const KerfCase& test_case) const;
  /// Outcome with the picture and all that was measured.
  struct Whole {
    KerfOutcome outcome;
    GrayImage picture;
    KerfMeasurement measurement;
    CutTruth truth;
    World world;
  };
  [[nodiscard]] Whole runWhole(const KerfCase& test_case) const;
  /// Scales the first fault until KerfOutcome::truth_mm is as given, to 0.1 µm; other faults and the
  /// machine's flutter have a share in it.
  void scaleTo(double truth_mm, KerfCase& test_case) const;

 private:
  [[nodiscard]] World worldOf(const KerfCase& test_case) const;
  [[nodiscard]] ArtefactCut cutOf(const KerfCase& test_case, const World& world) const;

  const GaugeSetup& setup_;
  std::vector<KerfInstrument> instruments_;  ///< One for each CornerAngle.
};

}  // namespace kerfbench::gauge
