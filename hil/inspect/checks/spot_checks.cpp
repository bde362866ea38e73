// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/checks/spot_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/interval_words.h"
#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// What the live check allows beyond the limit of the kerf's.
constexpr double kLiveAllowance_mm = 0.012;
/// Share of frames away from every line beyond which the others are near one by chance. On carton-mounted, a
/// head off by half a millimetre, it is 0.98; on belt-ignored, which stillness must fail, 0.55.
constexpr double kNearlyAll = 0.9;

}  // namespace

std::string nameOf(const LitFrame& frame) {
  if (frame.entity >= 0) return nameOf(frame.unit, frame.entity);
  return fmt::format("unit {}, along no drawn line at {}", frame.unit, placeOf(frame.p_S_mm));
}

std::vector<std::string> spotProblems(const Evidence& evidence, const LitFrames& lit) {
  std::vector<std::string> problems = evidence.spot.problems;
  for (std::string& problem : frameProblems(evidence)) problems.push_back(std::move(problem));
  if (!evidence.spot_calibration) problems.emplace_back("There is no calibration of the spot camera.");
  const auto unstated = std::count_if(lit.frames.begin(), lit.frames.end(),
                                      [](const LitFrame& f) { return !(f.sigma_mm > 0.0); });
  if (unstated > 0) problems.push_back(fmt::format("{} spots state no uncertainty.", unstated));
  if (2 * lit.unplaced > lit.lit) {
    problems.push_back(
        fmt::format("In {} of {} frames with the spot alight no printed mark told where the sheet was.",
                    lit.unplaced, lit.lit));
  }
  return problems;
}

void countPasses(const Evidence& evidence, const LitFrames& lit, std::vector<EntityResult>& entities) {
  std::map<std::pair<int, int>, double> swept_mm;
  for (const LitRun& run : lit.runs) {
    double last_step_mm = 0.0;
    // A step counts once it is longer than noise, so that a resting beam does not seem to travel.
    std::size_t from = run.begin;
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      const LitFrame& a = lit.frames[from];
      const LitFrame& b = lit.frames[i];
      const double step_mm = (b.p_S_mm - a.p_S_mm).norm();
      if (step_mm < 5.0 * b.sigma_mm && a.entity == b.entity) continue;
      // The piece before the first and after the last frame: half a step each, on average.
      if (from == run.begin && a.entity >= 0) swept_mm[{a.unit, a.entity}] += 0.5 * step_mm;
      if (a.entity >= 0) swept_mm[{a.unit, a.entity}] += 0.5 * step_mm;
      if (b.entity >= 0) swept_mm[{b.unit, b.entity}] += 0.5 * step_mm;
      last_step_mm = step_mm;
      from = i;
    }
    const LitFrame& last = lit.frames[run.end - 1];
    if (last.entity >= 0) swept_mm[{last.unit, last.entity}] += 0.5 * last_step_mm;
  }
  for (EntityResult& e : entities) {
    const dieline::Entity& entity = evidence.dieline->entities[static_cast<std::size_t>(e.entity)];
    double length_mm = dieline::lengthOf(entity.curve);
    // Over a bridge the spot is dark.
    if (entity.process == dieline::Process::kPerforation && e.coverage > 0.2) length_mm *= e.coverage;
    const auto found = swept_mm.find({e.unit, e.entity});
    e.passes = length_mm > 0.0 && found != swept_mm.end() ? found->second / length_mm : 0.0;
  }
}

bool isBesideEveryLine(const LitFrames& lit) {
  const auto off = std::ranges::count_if(lit.frames, isOffLine);
  return static_cast<double>(off) > kNearlyAll * static_cast<double>(lit.frames.size());
}

Check spotPathCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit) {
  Check check{.name = "spot_path", .title = "Spot on the dieline while cutting", .unit = "mm"};
  // The kerf decides about 0.05 mm. Live frames are noisier, so this check asks for less, and finds gross
  // errors even where no kerf lies within reach of a caliper.
  check.limit = limits.path_mm + kLiveAllowance_mm;
  check.value = kNan;
  // A spot too faint to be placed well (the laser is weak where the beam is slow) proves nothing here, unless
  // it is far off; such frames are counted and left to the kerf.
  const double usable_sigma_mm = 0.1 * limits.path_mm;
  const double map_u_mm = evidence.spot_calibration ? evidence.spot_calibration->map_u_mm : kNan;
  // One of the marks that tell where the sheet is may be misprinted; that makes no frame faint.
  const double place_u_mm = std::hypot(map_u_mm, evidence.print_sigma_mm);
  std::size_t faint = 0;
  const auto judged = [&](const LitFrame& f) {
    if (isOffLine(f)) return true;
    if (f.entity < 0 || f.ambiguous) return false;
    return std::hypot(f.sigma_mm, map_u_mm) <= usable_sigma_mm ||
           std::abs(f.deviation_mm) > 2.0 * check.limit;
  };
  for (const LitFrame& frame : lit.frames) {
    if (!isOffLine(frame) && frame.entity >= 0 && !frame.ambiguous && !judged(frame)) ++faint;
  }
  const auto count = static_cast<std::size_t>(std::count_if(lit.frames.begin(), lit.frames.end(), judged));
  ExtremeEstimate extreme(count);
  const LitFrame* worst = nullptr;
  double worst_mm = 0.0;
  std::size_t off = 0;
  for (const LitFrame& frame : lit.frames) {
    if (!judged(frame)) continue;
    if (isOffLine(frame)) ++off;
    const double deviation_mm = isOffLine(frame) ? frame.distance_mm : frame.deviation_mm;
    extreme.add(deviation_mm, std::hypot(frame.sigma_mm, place_u_mm));
    if (worst == nullptr || std::abs(deviation_mm) > std::abs(worst_mm)) {
      worst = &frame;
      worst_mm = deviation_mm;
    }
  }
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  const bool beyond = worst != nullptr && isOffLine(*worst) && worst->distance_mm >= kSearch_mm;
  if (beyond) {
    // No line was looked for farther away: the distance itself is not known.
    check.value = kSearch_mm;
    check.u = check.guard = 2.0 * std::hypot(worst->sigma_mm, place_u_mm);
    decideAtLeast(check);
  } else {
    decide(check);
  }
  if (worst == nullptr) {
    check.explanation = "The spot camera saw no spot that could be put on the dieline.";
    return check;
  }
  check.subject = nameOf(*worst);
  check.where = inFrame(*worst);
  check.explanation =
      beyond ? fmt::format(
                   "Of {} frames away from corners the one at {:.3f} s, {}, shows the spot {:g} mm or more "
                   "from the dieline on the moving sheet. How much more cannot be said: no line is looked "
                   "for farther away.",
                   count, worst->time_s, placeOf(worst->p_S_mm), kSearch_mm)
             : fmt::format(
                   "In {} frames away from corners the spot was at most {:.4f} mm from the dieline on the "
                   "moving sheet, at {:.3f} s, {}; the limit allows for the noise of a single frame.",
                   count, std::abs(worst_mm), worst->time_s, placeOf(worst->p_S_mm));
  if (!beyond) check.explanation += intervalWords(check);
  if (faint > 0) check.explanation += fmt::format(" In {} more it was too faint to be placed.", faint);
  if (off > 0) check.explanation += fmt::format(" {} frames show it away from every line.", off);
  return check;
}

}  // namespace kerfbench::inspect::checks
