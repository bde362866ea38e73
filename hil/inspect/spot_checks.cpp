// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/spot_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "hil/inspect/checks.h"
#include "hil/inspect/extreme.h"

namespace kerfbench::hil::checks {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMinNormalX = 0.7;    ///< Steeper lines do not let x be seen.
constexpr std::size_t kMinFrames = 5;  ///< For a slope that means something.
constexpr double kMinExpectedFrames = 4.0;

/// Standard uncertainty of a spot on the sheet: what was stated, or what the frame itself says if that is
/// worse.
double spotSigma(const Evidence& evidence, const LitFrame& frame) {
  return frame.sigma_mm > evidence.spot_u_mm ? frame.sigma_mm : evidence.spot_u_mm;
}

/// The entity with the most frames of a run; -1 if none has any.
int entityOfRun(const LitFrames& lit, const LitRun& run) {
  std::map<int, std::size_t> frames;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    if (lit.frames[i].entity >= 0) ++frames[lit.frames[i].entity];
  }
  const auto most = std::max_element(frames.begin(), frames.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == frames.end() ? -1 : most->first;
}

/// Least-squares line through the residuals of a cut.
void fitDrift(CutResult& cut, double sigma_mm) {
  const auto n = static_cast<double>(cut.residual_mm.size());
  double mean_t = 0.0;
  double mean_e = 0.0;
  for (std::size_t i = 0; i < cut.time_s.size(); ++i) {
    mean_t += cut.time_s[i] / n;
    mean_e += cut.residual_mm[i] / n;
  }
  double s_tt = 0.0;
  double s_te = 0.0;
  double s_ee = 0.0;
  for (std::size_t i = 0; i < cut.time_s.size(); ++i) {
    const double t = cut.time_s[i] - mean_t;
    const double e = cut.residual_mm[i] - mean_e;
    s_tt += t * t;
    s_te += t * e;
    s_ee += e * e;
  }
  cut.rms_mm = std::sqrt(s_ee / n);
  if (cut.residual_mm.size() < kMinFrames || !(s_tt > 0.0)) return;
  const double duration_s = cut.time_s.back() - cut.time_s.front();
  const double slope_mm_s = s_te / s_tt;
  // The scatter about the line itself speaks up if it is worse than what was stated.
  const double scatter_mm = std::sqrt(std::max(s_ee - slope_mm_s * s_te, 0.0) / (n - 2.0));
  cut.drift_mm = slope_mm_s * duration_s;
  cut.drift_sigma_mm = (scatter_mm > sigma_mm ? scatter_mm : sigma_mm) * duration_s / std::sqrt(s_tt);
}

bool isOffLine(const LitFrame& frame) { return frame.entity < 0 && frame.distance_mm > kReach_mm; }

}  // namespace

std::vector<std::string> spotProblems(const Evidence& evidence, const LitFrames& lit) {
  std::vector<std::string> problems = evidence.spot.problems;
  if (evidence.spot.frames.empty()) problems.emplace_back("The spot camera gave no frame.");
  if (evidence.spot.frames_lost > 0) {
    problems.push_back(fmt::format("The spot camera lost {} frames.", evidence.spot.frames_lost));
  }
  if (!(evidence.spot_u_mm > 0.0))
    problems.emplace_back("No measurement uncertainty is stated for the spot camera.");
  const bool broken = std::any_of(lit.frames.begin(), lit.frames.end(), [](const LitFrame& f) {
    return !f.p_S_mm.allFinite() || !std::isfinite(f.time_s);
  });
  if (broken) problems.emplace_back("A frame of the spot camera has a reading that is no number.");
  if (2 * lit.unplaced > lit.lit) {
    problems.push_back(
        fmt::format("In {} of {} frames with the spot alight no printed mark told where the sheet was.",
                    lit.unplaced, lit.lit));
  }
  return problems;
}

std::vector<CutResult> measureCuts(const Evidence& evidence, const LitFrames& lit) {
  std::vector<CutResult> cuts;
  for (const LitRun& run : lit.runs) {
    CutResult cut{.unit = lit.frames[run.begin].unit,
                  .entity = entityOfRun(lit, run),
                  .start_s = lit.frames[run.begin].time_s,
                  .end_s = lit.frames[run.end - 1].time_s,
                  .frames = 0,
                  .drift_mm = kNan,
                  .drift_sigma_mm = kNan,
                  .peak_mm = kNan,
                  .rms_mm = kNan,
                  .time_s = {},
                  .residual_mm = {}};
    double sum_of_variances = 0.0;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const LitFrame& frame = lit.frames[i];
      if (frame.entity < 0 || frame.ambiguous || std::abs(frame.n_x) < kMinNormalX) continue;
      const double residual_mm = frame.deviation_mm / frame.n_x;
      const double sigma_mm = spotSigma(evidence, frame) / std::abs(frame.n_x);
      sum_of_variances += sigma_mm * sigma_mm;
      cut.time_s.push_back(frame.time_s);
      cut.residual_mm.push_back(residual_mm);
      cut.peak_mm =
          std::isnan(cut.peak_mm) ? std::abs(residual_mm) : std::max(cut.peak_mm, std::abs(residual_mm));
    }
    cut.frames = static_cast<int>(cut.residual_mm.size());
    if (cut.frames > 0) fitDrift(cut, std::sqrt(sum_of_variances / static_cast<double>(cut.frames)));
    cuts.push_back(std::move(cut));
  }
  return cuts;
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
      if (step_mm < 5.0 * spotSigma(evidence, b) && a.entity == b.entity) continue;
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
    const Entity& entity = evidence.dieline->entities[static_cast<std::size_t>(e.entity)];
    double length_mm = lengthOf(entity.curve);
    // Over a bridge the spot is dark.
    if (entity.process == Process::kPerforation && e.coverage > 0.2) length_mm *= e.coverage;
    const auto found = swept_mm.find({e.unit, e.entity});
    e.passes = length_mm > 0.0 && found != swept_mm.end() ? found->second / length_mm : 0.0;
  }
}

Check stillnessCheck(const Limits& limits, const LitFrames& lit, const std::vector<CutResult>& cuts) {
  Check check{
      .name = "stillness_x", .title = "Beam at rest relative to the moving sheet, along x", .unit = "mm"};
  check.limit = limits.stillness_mm;
  check.value = kNan;
  const auto judged = static_cast<std::size_t>(
      std::count_if(cuts.begin(), cuts.end(), [](const CutResult& c) { return std::isfinite(c.drift_mm); }));
  ExtremeEstimate extreme(judged);
  const CutResult* worst = nullptr;
  for (const CutResult& cut : cuts) {
    if (!std::isfinite(cut.drift_mm)) continue;
    extreme.add(cut.drift_mm, cut.drift_sigma_mm);
    if (worst == nullptr || std::abs(cut.drift_mm) > std::abs(worst->drift_mm)) worst = &cut;
  }
  if (worst != nullptr) {
    check.value = extreme.value();
    check.u = check.guard = extreme.expandedU();
    decide(check);
    check.subject = nameOf(worst->unit, worst->entity);
    check.explanation = fmt::format(
        "Of {} cuts that show x, the spot drifted most against the sheet in the one of {} at {:.3f} s: "
        "{:+.4f} mm over "
        "{:.0f} ms, standard uncertainty {:.4f} mm.",
        judged, check.subject, worst->start_s, worst->drift_mm,
        1e3 * (worst->time_s.back() - worst->time_s.front()), worst->drift_sigma_mm);
    if (judged < cuts.size()) {
      check.explanation += fmt::format(
          " {} cuts run along x, are shorter than {} frames or are off the dieline, and "
          "cannot show it.",
          cuts.size() - judged, kMinFrames);
    }
    return check;
  }
  // No cut stayed with the dieline. If the spot was seen to leave it, that is proof enough.
  const LitFrame* farthest = nullptr;
  std::size_t off = 0;
  for (const LitFrame& frame : lit.frames) {
    if (!isOffLine(frame)) continue;
    ++off;
    if (farthest == nullptr || frame.distance_mm > farthest->distance_mm) farthest = &frame;
  }
  if (farthest != nullptr && 2 * off > lit.frames.size()) {
    check.value = farthest->distance_mm;
    check.subject = fmt::format("unit {}", farthest->unit);
    decide(check);
    check.explanation = fmt::format(
        "The spot did not stay with any line: in {} of {} frames it was more than {:.1f} mm from the dieline "
        "on the "
        "moving sheet, at {:.3f} s by {:.2f} mm or more. No cut could be followed to measure the drift "
        "itself.",
        off, lit.frames.size(), kReach_mm, farthest->time_s, farthest->distance_mm);
    return check;
  }
  decide(check);
  check.explanation = fmt::format(
      "None of {} cuts lets the motion along x be seen: it takes {} frames on a line that "
      "runs across the belt.",
      cuts.size(), kMinFrames);
  return check;
}

Check spotPathCheck(const Evidence& evidence, const Limits& limits, const LitFrames& lit) {
  Check check{.name = "spot_path", .title = "Spot on the dieline while cutting", .unit = "mm"};
  // The kerf decides about 0.05 mm. Live frames are noisier, so this check asks for less, and finds gross
  // errors even where no kerf lies within reach of a caliper.
  check.limit = limits.path_mm + 4.0 * evidence.spot_u_mm;
  check.value = kNan;
  // A spot too faint to be placed well (the laser is weak where the beam is slow) proves nothing here, unless
  // it is far off; such frames are counted and left to the kerf.
  const double usable_sigma_mm = 0.1 * limits.path_mm;
  std::size_t faint = 0;
  const auto judged = [&](const LitFrame& f) {
    if (isOffLine(f)) return true;
    if (f.entity < 0 || f.ambiguous) return false;
    return spotSigma(evidence, f) <= usable_sigma_mm || std::abs(f.deviation_mm) > 2.0 * check.limit;
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
    extreme.add(deviation_mm, spotSigma(evidence, frame));
    if (worst == nullptr || std::abs(deviation_mm) > std::abs(worst_mm)) {
      worst = &frame;
      worst_mm = deviation_mm;
    }
  }
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  decide(check);
  if (worst == nullptr) {
    check.explanation = "The spot camera saw no spot that could be put on the dieline.";
    return check;
  }
  check.subject =
      worst->entity >= 0 ? nameOf(worst->unit, worst->entity) : fmt::format("unit {}", worst->unit);
  check.explanation = fmt::format(
      "In {} frames away from corners the spot was at most {:.4f} mm{} from the dieline on the moving sheet, "
      "at {:.3f} s, "
      "{}; the limit allows for the noise of a single frame.",
      count, std::abs(worst_mm), worst_mm >= kSearch_mm ? " or more" : "", worst->time_s,
      placeOf(worst->p_S_mm));
  if (faint > 0) check.explanation += fmt::format(" In {} more it was too faint to be placed.", faint);
  if (off > 0) check.explanation += fmt::format(" {} frames show it away from every line.", off);
  return check;
}

Check repeatCheck(const Evidence& evidence, const Limits& limits, const LitFrames& lit,
                  const std::vector<EntityResult>& entities) {
  Check check{.name = "repeat", .title = "No line is cut twice"};
  check.limit = limits.passes;
  check.value = kNan;
  std::vector<double> steps_mm;
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      steps_mm.push_back((lit.frames[i].p_S_mm - lit.frames[i - 1].p_S_mm).norm());
    }
  }
  const double step_mm = medianOf(std::move(steps_mm));
  std::size_t judged = 0;
  for (const EntityResult& e : entities) {
    const double length_mm = lengthOf(evidence.dieline->entities[static_cast<std::size_t>(e.entity)].curve);
    if (!(length_mm >= kMinExpectedFrames * step_mm)) continue;
    ++judged;
    const double u = std::min(step_mm / length_mm, 0.25);
    if (!std::isnan(check.value) && e.passes <= check.value) continue;
    check.value = e.passes;
    check.u = check.guard = u;
    check.subject = nameOf(e.unit, e.entity);
  }
  decide(check);
  if (judged == 0) {
    check.explanation = "The spot camera saw no line long enough to count how often it was cut.";
    return check;
  }
  check.explanation =
      check.verdict == Verdict::kPass
          ? fmt::format("None of {} lines was followed more than once; the most is {:.2f} times, {}.", judged,
                        check.value, check.subject)
          : fmt::format("The spot went along {} {:.2f} times: it was cut more than once, at least in part.",
                        check.subject, check.value);
  if (judged < entities.size()) {
    check.explanation += fmt::format(
        " {} lines are too short for the camera to count; their kerf width tells.", entities.size() - judged);
  }
  return check;
}

}  // namespace kerfbench::hil::checks
