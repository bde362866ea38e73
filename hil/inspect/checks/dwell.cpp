// SPDX-License-Identifier: Apache-2.0
// Whether the beam rests anywhere on the sheet while the laser works. The kerf's calipers do not show it: the
// hole lies evenly about the line, and a width is the mean of its line.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/evidence/emitted_light.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// Places of the spot within this of each other are one: about the radius of a beam.
constexpr double kPlace_mm = 0.1;
/// Steps of the spot shorter than this are noise in part, and tell no light per length.
constexpr double kStep_mm = 0.05;
/// The job's own light per length is that of its strongest cuts: creases get less.
constexpr double kStrong = 0.9;

/// A stay of the spot at one place, with times of full power that give as much light.
struct Rest {
  const LitFrame* at{};
  double light_s{};   ///< Between the first and the last frame that show it there.
  double beside_s{};  ///< Within the frame before and the one after: what no way of the spot asked for.
  double time_s{};
  [[nodiscard]] double most_s() const { return light_s + beside_s; }
};

double wayOf(const LitFrame& a, const LitFrame& b) { return (b.p_S_mm - a.p_S_mm).norm(); }

/// Finds the place of the sheet that gets the most light.
class RestFinder {
 public:
  /// @param of_cuts_s_mm Light of the job's own cuts.
  /// @param is_fine The frames are dense enough for what lies between two of them to mean something.
  RestFinder(const LitFrames& lit, const EmittedLight& light, double of_cuts_s_mm, bool is_fine)
      : lit_(lit), light_(light), of_cuts_s_mm_(of_cuts_s_mm), is_fine_(is_fine) {}

  [[nodiscard]] Rest longest() const {
    Rest longest;
    for (const LitRun& run : lit_.runs) {
      std::size_t last = run.begin;
      for (std::size_t first = run.begin; first < run.end; ++first) {
        last = std::max(last, first);
        const LitFrame& from = lit_.frames[first];
        while (last + 1 < run.end && wayOf(from, lit_.frames[last + 1]) <= kPlace_mm) ++last;
        const LitFrame& to = lit_.frames[last];
        const Rest rest{&from, lightWithin(from.time_s, to.time_s), before(run, first) + after(run, last),
                        to.time_s - from.time_s};
        if (longest.at == nullptr || rest.most_s() > longest.most_s()) longest = rest;
      }
    }
    return longest;
  }

 private:
  [[nodiscard]] double lightWithin(double from_s, double to_s) const {
    return light_.until(to_s) - light_.until(from_s);
  }
  [[nodiscard]] double surplus(double light_s, double way_mm) const {
    return std::max(light_s - way_mm * of_cuts_s_mm_, 0.0);
  }
  /// At an end of a run its nearest step tells the speed. A run of one frame tells none.
  [[nodiscard]] double speedOf(std::size_t frame) const {
    const LitFrame& a = lit_.frames[frame];
    const LitFrame& b = lit_.frames[frame + 1];
    return wayOf(a, b) / (b.time_s - a.time_s);
  }
  [[nodiscard]] double before(const LitRun& run, std::size_t first) const {
    if (!is_fine_ || run.end - run.begin < 2) return 0.0;
    const LitFrame& from = lit_.frames[first];
    if (first > run.begin) {
      const LitFrame& last = lit_.frames[first - 1];
      return surplus(lightWithin(last.time_s, from.time_s), wayOf(last, from));
    }
    return surplus(lightWithin(from.time_s - lit_.period_s, from.time_s), speedOf(first) * lit_.period_s);
  }
  [[nodiscard]] double after(const LitRun& run, std::size_t last) const {
    if (!is_fine_ || run.end - run.begin < 2) return 0.0;
    const LitFrame& to = lit_.frames[last];
    if (last + 1 < run.end) {
      const LitFrame& next = lit_.frames[last + 1];
      return surplus(lightWithin(to.time_s, next.time_s), wayOf(to, next));
    }
    return surplus(lightWithin(to.time_s, to.time_s + lit_.period_s), speedOf(last - 1) * lit_.period_s);
  }

  const LitFrames& lit_;
  const EmittedLight& light_;
  double of_cuts_s_mm_;
  bool is_fine_;
};

/// Light of full power for each mm of the strongest cuts, s/mm; NaN if no step of the spot tells it.
double lightOfCuts(const LitFrames& lit, const EmittedLight& light) {
  std::vector<double> each_s_mm;
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      const LitFrame& a = lit.frames[i - 1];
      const LitFrame& b = lit.frames[i];
      const double step_mm = wayOf(a, b);
      if (step_mm >= kStep_mm) each_s_mm.push_back((light.until(b.time_s) - light.until(a.time_s)) / step_mm);
    }
  }
  if (each_s_mm.empty()) return kNan;
  const auto strong =
      each_s_mm.begin() + static_cast<std::ptrdiff_t>(kStrong * static_cast<double>(each_s_mm.size() - 1));
  std::ranges::nth_element(each_s_mm, strong);
  return *strong;
}

/// Most frames are no farther apart than so much of the job's cuts.
bool areWithin(double way_mm, const LitFrames& lit) {
  std::vector<double> steps_mm;
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i)
      steps_mm.push_back(wayOf(lit.frames[i - 1], lit.frames[i]));
  }
  return !steps_mm.empty() && medianOf(std::move(steps_mm)) <= way_mm;
}

}  // namespace

Finding dwellCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit) {
  Check check{.name = "dwell", .title = "The beam rests nowhere while the laser works", .unit = "mm"};
  check.limit = limits.dwell_mm;
  const EmittedLight light(evidence.light);
  const double of_cuts_s_mm = lightOfCuts(lit, light);
  const Rest rest = RestFinder(lit, light, of_cuts_s_mm, areWithin(check.limit, lit)).longest();
  if (rest.at == nullptr || !(of_cuts_s_mm > 0.0))
    return notJudged(check, "The spot camera saw no cut whose light the pins tell.");
  // The spot came to the place and left it within a frame each: how much of their light fell there is open.
  const double open_mm = 0.5 * rest.beside_s / of_cuts_s_mm;
  check.value = rest.light_s / of_cuts_s_mm + open_mm;
  check.u = check.guard = 2.0 * kPlace_mm + open_mm;
  check.subject = nameOf(*rest.at);
  check.where = inFrame(*rest.at);
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
