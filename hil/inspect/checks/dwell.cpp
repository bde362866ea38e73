// SPDX-License-Identifier: Apache-2.0
// Whether the beam rests anywhere on the sheet while the laser works. The kerf's calipers do not show it: the
// hole lies evenly about the line, and a width is the mean of its line.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "twin/base/constants.h"

namespace kerfbench::inspect::checks {
namespace {

/// Places of the spot within this of each other are one: about the radius of a beam.
constexpr double kPlace_mm = 0.1;
/// Steps of the spot shorter than this are noise in part, and tell no light per length.
constexpr double kStep_mm = 0.05;
/// The job's own light per length is that of its strongest cuts: creases get less.
constexpr double kStrong = 0.9;

/// Time for which the laser emitted up to a given time, from the pins.
class Light {
 public:
  explicit Light(const std::vector<Span>& spans) : spans_(spans) {
    double sum_s = 0.0;
    for (const Span& span : spans) {
      before_s_.push_back(sum_s);
      sum_s += span.to_s - span.from_s;
    }
  }
  [[nodiscard]] double until(double time_s) const {
    const auto after = std::ranges::upper_bound(spans_, time_s, {}, &Span::from_s);
    if (after == spans_.begin()) return 0.0;
    const auto last = static_cast<std::size_t>(after - spans_.begin()) - 1;
    return before_s_[last] + std::min(time_s, spans_[last].to_s) - spans_[last].from_s;
  }

 private:
  const std::vector<Span>& spans_;
  std::vector<double> before_s_;
};

struct Rest {
  const LitFrame* at{};
  double light_s{};  ///< Time of full power that gives as much light.
  double time_s{};
};

/// The most light between the first and the last of neighbouring frames that show the spot at one place.
Rest longestRest(const LitFrames& lit, const Light& light) {
  Rest longest;
  for (const LitRun& run : lit.runs) {
    std::size_t last = run.begin;
    for (std::size_t first = run.begin; first < run.end; ++first) {
      last = std::max(last, first);
      const LitFrame& from = lit.frames[first];
      while (last + 1 < run.end && (lit.frames[last + 1].p_S_mm - from.p_S_mm).norm() <= kPlace_mm) ++last;
      const double light_s = light.until(lit.frames[last].time_s) - light.until(from.time_s);
      if (longest.at == nullptr || light_s > longest.light_s)
        longest = {&from, light_s, lit.frames[last].time_s - from.time_s};
    }
  }
  return longest;
}

/// Light of full power for each mm of the strongest cuts, s/mm; NaN if no step of the spot tells it.
double lightOfCuts(const LitFrames& lit, const Light& light) {
  std::vector<double> each_s_mm;
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      const LitFrame& a = lit.frames[i - 1];
      const LitFrame& b = lit.frames[i];
      const double step_mm = (b.p_S_mm - a.p_S_mm).norm();
      if (step_mm >= kStep_mm) each_s_mm.push_back((light.until(b.time_s) - light.until(a.time_s)) / step_mm);
    }
  }
  if (each_s_mm.empty()) return kNan;
  const auto strong =
      each_s_mm.begin() + static_cast<std::ptrdiff_t>(kStrong * static_cast<double>(each_s_mm.size() - 1));
  std::ranges::nth_element(each_s_mm, strong);
  return *strong;
}

}  // namespace

Finding dwellCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit) {
  Check check{.name = "dwell", .title = "The beam rests nowhere while the laser works", .unit = "mm"};
  check.limit = limits.dwell_mm;
  const Light light(evidence.light);
  const double of_cuts_s_mm = lightOfCuts(lit, light);
  const Rest rest = longestRest(lit, light);
  if (rest.at == nullptr || !(of_cuts_s_mm > 0.0))
    return notJudged(check, "The spot camera saw no cut whose light the pins tell.");
  check.value = rest.light_s / of_cuts_s_mm;
  // The spot came to the place and left it within a frame each.
  check.u = check.guard = std::min(2.0 * kPlace_mm, 0.5 * check.limit);
  check.subject = nameOf(rest.at->unit, rest.at->entity);
  decide(check);
  check.explanation = fmt::format(
      "The most light on one place of {:.1f} mm fell at {:.3f} s, {}, within {:.1f} ms: as much as {:.2f} mm "
      "of "
      "the job's own cuts get. Shorter rests than a frame of {:.1f} ms are not seen.",
      kPlace_mm, rest.at->time_s, placeOf(rest.at->p_S_mm), 1e3 * rest.time_s, check.value,
      1e3 * lit.period_s);
  return check;
}

}  // namespace kerfbench::inspect::checks
