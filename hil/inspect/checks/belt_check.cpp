// SPDX-License-Identifier: Apache-2.0
// Does the sheet move in the pictures as the belt's encoder says? Two witnesses that share nothing.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/interval_words.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr std::size_t kLeastFrames = 5;  // for a slope that means something
constexpr double kLeastCounts = 2.0;     // Least travel in counts; below it rounding is all that there is.
constexpr double kCoarse =
    0.5;  // Share of the limit above which the uncertainty of an encoder makes it useless.

/// Place of the belt between the encoder's edges, mm.
double beltAt(const std::vector<BeltEdge>& edges, double time_s) {
  const auto after = std::upper_bound(edges.begin(), edges.end(), time_s,
                                      [](double t, const BeltEdge& e) { return t < e.time_s; });
  if (after == edges.begin()) return edges.front().x_mm;
  if (after == edges.end()) return edges.back().x_mm;
  const BeltEdge& before = *(after - 1);
  const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
  return before.x_mm + share * (after->x_mm - before.x_mm);
}

struct Parting {
  const LitFrame* first{};
  double drift_mm{};   ///< Sheet less belt, over the cut, by least squares.
  double sigma_mm{};   ///< Standard uncertainty from the scatter about that line.
  double travel_mm{};  ///< Travel of the belt.
};

std::optional<Parting> partingOf(const std::vector<BeltEdge>& edges, const LitFrames& lit,
                                 const LitRun& run) {
  const auto n = static_cast<Eigen::Index>(run.end - run.begin);
  if (n < static_cast<Eigen::Index>(kLeastFrames)) return std::nullopt;
  Eigen::VectorXd t(n), apart(n), belt(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const LitFrame& frame = lit.frames[run.begin + static_cast<std::size_t>(i)];
    t[i] = frame.time_s;
    belt[i] = beltAt(edges, frame.time_s);
    apart[i] = frame.sheet_x_mm - belt[i];
  }
  t.array() -= t.mean();
  apart.array() -= apart.mean();
  const double s_tt = t.squaredNorm();
  if (!(s_tt > 0.0)) return std::nullopt;
  const double slope_mm_s = t.dot(apart) / s_tt;
  const double scatter_mm = std::sqrt((apart - slope_mm_s * t).squaredNorm() / static_cast<double>(n - 2));
  const double duration_s = t[n - 1] - t[0];
  return Parting{&lit.frames[run.begin], slope_mm_s * duration_s, scatter_mm * duration_s / std::sqrt(s_tt),
                 belt[n - 1] - belt[0]};
}

}  // namespace

Finding beltCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit) {
  // Both ends of a cut lie between two counts.
  const double of_counts_mm = std::sqrt(2.0 / 12.0) * evidence.belt_count_mm;
  Check check{.name = "belt", .title = "Sheet in the pictures and belt's encoder agree", .unit = "mm"};
  if (evidence.belt.empty())
    return notApplicable(check, "The belt's encoder did not turn: the sheet was at rest.");
  if (2.0 * of_counts_mm > kCoarse * limits.stillness_mm)
    return notJudged(check,
                     fmt::format("A count of the encoder is {:g} mm: too coarse for a limit of {:g} mm.",
                                 evidence.belt_count_mm, limits.stillness_mm));
  std::vector<Parting> partings;
  double apart_mm = 0.0;
  double travel_mm = 0.0;
  for (const LitRun& run : lit.runs) {
    const auto parting = partingOf(evidence.belt, lit, run);
    if (!parting || std::abs(parting->travel_mm) < kLeastCounts * evidence.belt_count_mm) continue;
    partings.push_back(*parting);
    apart_mm += parting->drift_mm;
    travel_mm += parting->travel_mm;
  }
  if (partings.empty())
    return notJudged(check, "No cut has enough frames and travel of the belt to compare the two.");
  ExtremeEstimate extreme(partings.size());
  const Parting* worst = &partings.front();
  for (const Parting& p : partings) {
    extreme.add(p.drift_mm, std::hypot(p.sigma_mm, of_counts_mm));
    if (std::abs(p.drift_mm) > std::abs(worst->drift_mm)) worst = &p;
  }
  check.limit = limits.stillness_mm;
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  check.subject = fmt::format("unit {}", worst->first->unit);
  check.where = inFrame(*worst->first);
  // Which of the two is wrong cannot be told from here: no proof against a release.
  if (decide(check) == Verdict::kFail) check.verdict = Verdict::kInvalid;
  check.explanation = fmt::format(
      "Of {} cuts the pictures and the encoder part most in the one at {:.3f} s: the sheet moves {:+.4f} mm "
      "more than the encoder's {:.2f} mm; over all cuts {:+.4f} % of the way.",
      partings.size(), worst->first->time_s, worst->drift_mm, worst->travel_mm, 100.0 * apart_mm / travel_mm);
  check.explanation += intervalWords(check);
  return check;
}

}  // namespace kerfbench::inspect::checks
