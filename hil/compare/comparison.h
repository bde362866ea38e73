// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/compare/run_figures.h"

namespace kerfbench::compare {

/// Runs of one release on one job: one run, or several with other seeds.
struct RunSet {
  std::string name;              ///< For people: a folder, or "4 runs of firmware 6502e17e".
  std::vector<RunFigures> runs;  ///< Never empty.
};

/// One figure of both releases.
struct Difference {
  Figure::Of of{};
  std::string place, quantity, unit;
  double old_value{}, new_value{};  ///< Means of several runs.
  /// new - old, and its expanded uncertainty (k = 2); 0 where neither release states one.
  double difference{}, u{};
  /// Ratio of the difference to its standard uncertainty, as a quantile of the normal distribution: that of
  /// Student is converted where the spread of few runs was used.
  double z{};
  bool significant{};  ///< See Comparison::threshold_z.
  bool worse{};        ///< Significant, and away from what is good. A width is never worse.
  bool better{};       ///< Significant, and towards what is good.
};

/// A check that was judged in one release and not in the other, or by another verdict.
struct VerdictChange {
  std::string check, old_verdict, new_verdict;  ///< "not judged" where it was not.
  std::string why;                              ///< Reason why it was not judged.
  /// No longer judged, INVALID where it was not, or a worse verdict of a value that differs significantly.
  bool worse{};
};

/// Comparison of a new release with an old one.
struct Comparison {
  std::vector<Difference> differences;  ///< The most significant first.
  std::vector<VerdictChange> verdicts;  ///< Sorted by check.
  /// What is compared with care: other machine, job or bench; machines sampled anew by another seed.
  std::vector<std::string> cautions;
  /// A difference counts whose z is beyond this: all m figures of a comparison together raise a false alarm
  /// in one of 200 (Šidák's correction, two-sided).
  double threshold_z{};
  /// Figures that only one of the two has: places.
  std::vector<std::string> only_old, only_new;
  /// False where the two ran on machines that were sampled anew by another seed, with too few runs to know
  /// how far machines differ: no difference of a figure is held against the release then.
  bool told_apart{true};

  [[nodiscard]] bool anythingWorse() const;
};

/// Compares figure by figure. The standard uncertainty of a difference is that of both measurements; where a
/// set has at least kFewestRunsForSpread runs, the spread of its runs counts instead if it is larger (mean of
/// n runs: s/√n, Student's t of n - 1). Systematic parts that both runs share are counted twice: the
/// comparison rather misses than invents.
/// @throws base::InputError if the runs of a set are of other firmware or jobs, or the two sets of other jobs
/// (scenario's name).
Comparison compareReleases(const RunSet& old_release, const RunSet& new_release);

/// As many runs show how far machines of other seeds differ.
inline constexpr std::size_t kFewestRunsForSpread = 4;
/// Chance of a false alarm of a whole comparison.
inline constexpr double kFalseAlarms = 0.005;

}  // namespace kerfbench::compare
