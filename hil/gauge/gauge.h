// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/gauge/case_plan.h"
#include "hil/gauge/statistics.h"

namespace kerfbench::gauge {

/// Width of the tolerance that the studies are stated against: ±0.05 mm.
inline constexpr double kTolerance_mm = 0.1;

struct GaugeOptions {
  std::vector<twin::Preset> presets{twin::Preset::kStatic, twin::Preset::kDynamic};
  std::size_t bad{3000}, good{3000};  ///< Over all presets together.
  std::size_t coverage{1000};         ///< Cases of coverage for each preset.
  std::size_t still{1000};            ///< Cases of stillness for each preset.
  std::size_t repeats{50};            ///< Repetitions of each type-1 study of the kerf.
  std::size_t still_repeats{50};      ///< Repetitions of the study of the drift.
  bool grr{true};
  std::uint64_t seed{1};
  int jobs{1};
};

/// Rate at which an interval holds the truth.
struct Coverage {
  std::string quantity;
  /// The intervals may not hold the truth too often either. Those of kerfs do in the bench's own world:
  /// light, walls and radius are as told there, and U allows for others.
  bool two_sided{true};
  /// Whether it is held to a limit: in other worlds what no check judges is only shown.
  bool claimed{true};
  std::size_t cases{}, hits{}, missing{};  ///< missing: no number was measured.
  Interval share;                          ///< 95 % confidence interval of hits / cases.
  Moments error_mm;
  double U_median_mm{}, U_95_mm{}, U_most_mm{};
  double z_sigma{};  ///< RMS of error over U/2: 1 if U is right, more if it is too small.
  double z_mean{};
  std::vector<std::string> worst;  ///< The cases that miss by most U, up to five.
};

/// Results of one fault kind.
struct KindResult {
  FaultKind kind{};
  std::map<inspect::Verdict, std::size_t> bad, good;
  /// Size from which on at least 95 % of the cuts are FAIL, with 95 % confidence (order statistic of how far
  /// the truth lies above the lower end of what is stated); NaN where too few were seen or none was FAIL.
  double detectable_mm{};
  std::size_t detectable_from{};  ///< Cases that it rests on.
};

/// Mean error of the readings in a part of the kerf camera's field, plane V.
struct FieldCell {
  Eigen::Vector2d p_V_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d bias_mm{Eigen::Vector2d::Zero()};
  double sigma_mm{};  ///< Standard uncertainty of the bias per axis, if cases were independent of each other.
  std::size_t readings{};
};

/// Budget (JCGM 100) against Monte-Carlo (JCGM 101) against what was seen.
struct BudgetCheck {
  std::size_t cases{};
  double median_ratio{};       ///< Budget's U over Monte-Carlo's.
  double within_10_percent{};  ///< Share of cases.
  double p95_departure{};      ///< 95th percentile of |ratio - 1|.
  double observed_ratio{};     ///< RMS of error over RMS of Monte-Carlo's U / 2.
};

struct GaugePoint {
  std::string name;
  FaultKind kind{};
  inspect::Verdict verdict{};
  double truth_mm{}, value_mm{}, U_mm{};
};

/// All that is known of one preset.
struct GaugeSection {
  std::string preset;
  std::vector<Coverage> coverage;
  std::vector<KindResult> kinds;
  std::vector<GaugePoint> worst;   ///< Worst deviation of the lines, all cases of good, bad and coverage.
  std::vector<GaugePoint> joints;  ///< Good and bad cases of corner and end; value and U are NaN.
  std::vector<GaugePoint> drift;   ///< Largest drift.
  std::vector<std::string> wrong;  ///< "static-bad-17: PASS with 56.1 um (end)"
  bool mismatch{};                 ///< Seen in worlds that are not the bench's own.
  /// Cases that ended INVALID: of bad and good cuts, and in other worlds of coverage as well.
  std::size_t invalid{}, of{};
  std::map<inspect::Verdict, std::size_t> bad, good;
  std::vector<double> repeat_mm, relay_mm, drift_repeat_mm;  ///< Errors, in order.
  std::optional<TypeOne> repeat, relay, drift_repeat;
  std::optional<Grr> grr;
  std::optional<Linearity> linearity, drift_linearity;
  std::vector<FieldCell> field;
  BudgetCheck budget, drift_budget;
};

struct Claim {
  enum class State { kHolds, kFails, kOpen };
  std::string preset;
  std::string what;
  std::string measured;  ///< Value with its unit.
  std::string limit;
  State state{State::kOpen};  ///< kOpen: too few cases to decide.
};

struct GaugeResult {
  std::vector<GaugeSection> sections;
  std::vector<Claim> claims;
  std::size_t kerf_cases{}, still_cases{};
  /// True where no claim failed. Open ones do not count.
  [[nodiscard]] bool holds() const;
};

/// Cases done, of how many.
using GaugeProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Runs all cases and draws the conclusions. The result is the same at any number of jobs. `progress` is
/// called from one thread at a time.
GaugeResult runGauge(const GaugeSetup& setup, const GaugeOptions& options, const GaugeProgress& progress);

// The parts, pure.
GaugeSection sectionOf(const std::string& preset, const std::vector<std::pair<CaseId, KerfOutcome>>& kerf,
                       const std::vector<std::pair<CaseId, StillOutcome>>& still, bool mismatch = false);
std::vector<Claim> claimsOf(const GaugeSection& section);
Coverage coverageOf(const std::string& quantity,
                    const std::vector<std::pair<std::string, Reading>>& readings);

}  // namespace kerfbench::gauge
