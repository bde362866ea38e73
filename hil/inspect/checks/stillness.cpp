// SPDX-License-Identifier: Apache-2.0
// Does the beam rest on the moving sheet, along x, during each cut?
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/cut_readings.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/deviation/worst_deviation.h"
#include "hil/inspect/evidence/print_error.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr double kMinNormalX = 0.7;         ///< Steeper lines do not let x be seen.
constexpr std::size_t kMinSlopeFrames = 5;  ///< For a slope that means something.
constexpr double kFaintFrame = 4.0;         ///< Times the noise of a cut's other frames.
constexpr std::uint64_t kStillnessSeed = 0x7374696c6c6d6d31ULL;

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

/// Whether a spot has left its line farther than lines are looked for, and did not come back along it. Which
/// line it follows there is not known, and a distance from the one that it left tells no motion.
bool isLost(const LitFrame& frame) {
  return frame.entity < 0 && frame.left_entity >= 0 && !frame.beside &&
         std::abs(frame.deviation_mm) > kSearch_mm;
}

/// Whether a frame shows x of the spot on a line.
bool showsX(const LitFrame& frame) {
  return (frame.entity >= 0 || frame.left_entity >= 0) && !isLost(frame) && !frame.ambiguous &&
         std::abs(frame.n_x) >= kMinNormalX;
}

/// Frames that the laser lit for a part of the exposure only, as at the ends of a cut: the spot is faint, and
/// the sheet's place is that of another moment. Told by the stated noise alone, never by the reading.
double faintestSigma_mm(const LitFrames& lit, const LitRun& run) {
  std::vector<double> sigma_mm;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    if (showsX(lit.frames[i])) sigma_mm.push_back(lit.frames[i].sigma_mm);
  }
  return sigma_mm.empty() ? 0.0 : kFaintFrame * medianOf(std::move(sigma_mm));
}

/// Columns of CutReadings::shared.
Eigen::Index sharedColumns(const Evidence& evidence, const ModeField& field) {
  return field.modes() + 2 * static_cast<Eigen::Index>(evidence.print.marks.size());
}

/// Frames of a run that show x.
std::vector<std::size_t> framesWithX(const LitFrames& lit, const LitRun& run) {
  const double faintest_mm = faintestSigma_mm(lit, run);
  std::vector<std::size_t> frames;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    if (showsX(lit.frames[i]) && !(lit.frames[i].sigma_mm > faintest_mm)) frames.push_back(i);
  }
  return frames;
}

/// As CutReadings::shared has it.
Eigen::MatrixXd sharedErrors(const Evidence& evidence, const LitFrames& lit, const LitRun& run,
                             const ModeField& field) {
  const std::vector<std::size_t> frames = framesWithX(lit, run);
  const Eigen::Index columns = sharedColumns(evidence, field);
  Eigen::MatrixXd shared(static_cast<Eigen::Index>(frames.size()), columns);
  for (Eigen::Index row = 0; row < shared.rows(); ++row) {
    const LitFrame& frame = lit.frames[frames[static_cast<std::size_t>(row)]];
    const auto& spot_W_mm = evidence.spot.frames[frame.frame].spot_W_mm;
    const double n_y = std::sqrt(std::max(1.0 - frame.n_x * frame.n_x, 0.0));
    const Eigen::RowVector2d along_x(1.0, n_y / std::abs(frame.n_x));
    for (Eigen::Index k = 0; k < field.modes(); ++k) {
      const Eigen::Vector2d shift = spot_W_mm ? field.at(k, *spot_W_mm) : Eigen::Vector2d::Zero();
      shared(row, k) = along_x * shift;
    }
    shared.row(row).tail(columns - field.modes()) =
        evidence.print_sigma_mm * along_x * printInfluence(evidence.print, frame.marks, frame.p_S_mm);
  }
  return shared;
}

/// `evidence`, `lit` and `field` must outlive the readings.
CutResult readCut(const Evidence& evidence, const LitFrames& lit, const LitRun& run, const ModeField& field,
                  CutReadings& readings) {
  CutResult cut;
  cut.unit = lit.frames[run.begin].unit;
  cut.entity = entityOfRun(lit, run);
  cut.start_s = lit.frames[run.begin].time_s;
  cut.end_s = lit.frames[run.end - 1].time_s;
  measureTopSpeed(lit, run, cut);
  cut.drift_mm = cut.drift_sigma_mm = cut.slope_mm_s = cut.slope_sigma_mm_s = kNan;
  cut.peak_mm = cut.peak_U_mm = cut.rms_mm = cut.rms_U_mm = kNan;
  cut.offset_mm = cut.offset_sigma_mm = cut.excursion_mm = cut.excursion_U_mm = kNan;
  cut.track.reserve(run.end - run.begin);
  for (std::size_t i = run.begin; i < run.end; ++i) {
    const LitFrame& frame = lit.frames[i];
    cut.track.push_back({frame.time_s, std::max(frame.entity, frame.left_entity), frame.p_S_mm,
                         isLost(frame) ? kNan : frame.deviation_mm});
    if (isLost(frame)) ++cut.lost;
  }
  for (const std::size_t i : framesWithX(lit, run)) {
    const LitFrame& frame = lit.frames[i];
    cut.time_s.push_back(frame.time_s);
    cut.residual_mm.push_back(frame.deviation_mm / frame.n_x);
    cut.sheet_x_mm.push_back(frame.sheet_x_mm);
    readings.sigma_mm.push_back(frame.sigma_mm / std::abs(frame.n_x));
    ++cut.frames;
  }
  readings.columns = sharedColumns(evidence, field);
  readings.shared = [&evidence, &lit, run, &field] { return sharedErrors(evidence, lit, run, field); };
  return cut;
}

/// The scatter from frame to frame speaks up if it is beyond what the stated noise may show. By third
/// differences: what changes slowly is motion, and no noise.
void raiseToScatter(const Eigen::Map<const Eigen::VectorXd>& residual, std::vector<double>& sigma_mm) {
  const Eigen::Index n = residual.size() - 3;
  const double free = 0.43 * static_cast<double>(n);  // 20² / (20² + 2 (15² + 6² + 1²)) of n: they overlap.
  const double scatter =
      (residual.head(n) - 3.0 * residual.segment(1, n) + 3.0 * residual.segment(2, n) - residual.tail(n))
          .squaredNorm() /
      (20.0 * static_cast<double>(n));
  double stated = 0.0;
  for (const double s : sigma_mm) stated += s * s / static_cast<double>(sigma_mm.size());
  if (!(scatter > stated * (1.0 + 3.0 * std::sqrt(2.0 / free)))) return;
  for (double& s : sigma_mm) s *= std::sqrt(scatter / stated);
}

/// Least-squares line through the residuals of a cut; its uncertainty by noise that is correlated from frame
/// to frame. Returns how a shift of each frame moves the drift.
Eigen::VectorXd fitDrift(CutResult& cut, std::vector<double>& sigma_mm, double q) {
  const auto n = static_cast<Eigen::Index>(cut.residual_mm.size());
  if (n < static_cast<Eigen::Index>(kMinSlopeFrames)) return {};
  const Eigen::Map<const Eigen::VectorXd> time(cut.time_s.data(), n);
  const Eigen::Map<const Eigen::VectorXd> residual(cut.residual_mm.data(), n);
  const Eigen::VectorXd t = time.array() - time.mean();
  const double s_tt = t.squaredNorm();
  if (!(s_tt > 0.0)) return {};
  const double duration_s = cut.time_s.back() - cut.time_s.front();
  const Eigen::VectorXd slope_weight = t / s_tt;
  cut.slope_mm_s = slope_weight.dot(residual);
  cut.drift_mm = cut.slope_mm_s * duration_s;
  raiseToScatter(residual, sigma_mm);
  double variance = 0.0;
  double behind = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double own = slope_weight[i] * sigma_mm[static_cast<std::size_t>(i)];
    behind *= q;
    variance += own * (own + 2.0 * behind);
    behind += own;
  }
  cut.slope_sigma_mm_s = std::sqrt(std::max(variance, 0.0));
  cut.drift_sigma_mm = cut.slope_sigma_mm_s * duration_s;
  return slope_weight * duration_s;
}

/// Peak of the residuals and their RMS about the mean, by the same rules as deviations of the kerf.
void measurePeaks(const std::vector<CutReadings>& readings, double q, Eigen::Index modes, double by_pixel_mm,
                  int threads, std::vector<CutResult>& cuts) {
  ErrorModel peak{.lines = {}, .modes = modes, .estimator_mm = by_pixel_mm};
  peak.made = cuts.size();
  peak.make = [&](std::size_t i, ErrorModel::Part /*part*/) {
    return lineOf(cuts[i].residual_mm, readings[i].sigma_mm, readings[i].shared(), q);
  };
  const std::vector<LineKind> kinds(cuts.size(), LineKind{"", LineKind::Rms::kAboutMean, false, {}});
  const DeviationResult peaks = measureDeviations(peak, kinds, 0.0, kStillnessSeed, threads);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    cuts[i].peak_mm = peaks.lines[i].worst.value;
    cuts[i].peak_U_mm = peaks.lines[i].worst.U;
    cuts[i].rms_mm = peaks.lines[i].rms.value;
    cuts[i].rms_U_mm = peaks.lines[i].rms.U;
  }
}

/// The drift of each cut as a line of one reading: one tells nothing of another.
std::vector<ReadingLine> driftsOf(const std::vector<CutResult>& cuts,
                                  const std::vector<Eigen::VectorXd>& weights,
                                  const std::vector<CutReadings>& readings) {
  std::vector<ReadingLine> drifts;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    if (!std::isfinite(cuts[i].drift_mm)) continue;
    const Eigen::MatrixXd shared = weights[i].transpose() * readings[i].shared();
    drifts.push_back(lineOf({cuts[i].drift_mm}, {cuts[i].drift_sigma_mm}, shared, 0.0));
    drifts.back().caliper = {i};
  }
  return drifts;
}

}  // namespace

ReadingLine lineOf(const std::vector<double>& reading_mm, const std::vector<double>& sigma_mm,
                   const Eigen::MatrixXd& shared, double q) {
  ReadingLine line;
  line.reading_mm = reading_mm;
  line.sigma_mm = sigma_mm;
  line.q = q;
  line.segment = {0, line.size()};
  line.shared.setZero(shared.rows(), ReadingLine::kOwn + shared.cols());
  line.shared.rightCols(shared.cols()) = shared;
  return line;
}

Stillness measureCuts(const Evidence& evidence, const LitFrames& lit, const Tolerances& limits) {
  Stillness result;
  const ModeField field(evidence.spot_calibration.value_or(vision::CameraCalibration{}));
  std::vector<CutReadings> readings;
  NeighbourCorrelation correlation;
  for (const LitRun& run : lit.runs) {
    result.cuts.push_back(readCut(evidence, lit, run, field, readings.emplace_back()));
    std::vector<double> x = result.cuts.back().residual_mm;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] /= readings.back().sigma_mm[i];
    correlation.add(x);
  }
  const double q = correlation.value();
  std::vector<Eigen::VectorXd> weights;
  for (std::size_t i = 0; i < result.cuts.size(); ++i)
    weights.push_back(fitDrift(result.cuts[i], readings[i].sigma_mm, q));
  const Eigen::Index modes = sharedColumns(evidence, field);
  measurePeaks(readings, q, modes, placeInPixelSigma_mm(evidence), evidence.threads, result.cuts);
  measureExcursions(evidence, readings, q, limits.stillness_mm, result);

  const ErrorModel drifts{.lines = driftsOf(result.cuts, weights, readings), .modes = modes};
  // The camera's and the print's part of each drift, for people; the worst below knows that it is common to
  // all.
  for (const ReadingLine& drift : drifts.lines) {
    CutResult& cut = result.cuts[drift.caliper.front()];
    const double shared_mm = drift.shared.norm();
    const double scale = cut.slope_sigma_mm_s / cut.drift_sigma_mm;
    cut.drift_sigma_mm = std::hypot(cut.drift_sigma_mm, shared_mm);
    cut.slope_sigma_mm_s = scale * cut.drift_sigma_mm;
  }
  if (drifts.lines.empty()) return result;
  const DeviationResult worst = measureDeviations(drifts, std::vector<LineKind>(drifts.lines.size()),
                                                  limits.stillness_mm, kStillnessSeed + 1, evidence.threads);
  result.worst_drift_mm = worst.all.worst;
  result.chance_beyond = worst.chance_beyond;
  result.worst_cut = drifts.lines[worst.all.line].caliper.front();
  result.budget = worst.budget;
  result.budget.quantity = "largest drift along x of all cuts";
  if (!result.budget.entries.empty()) {
    result.budget.entries = {{"spot and sheet in each frame, through the line fitted to the cut",
                              worst.budget.entries[kByNoise].u, worst.budget.entries[kByNoise].correction},
                             worst.budget.entries[kByCamera],
                             worst.budget.entries[kByCompeting]};
  }
  return result;
}

namespace {

/// The drift of cuts that stayed with their lines.
void measuredDrift(const LitFrames& lit, const Stillness& stillness, std::size_t judged, Check& check) {
  const std::vector<CutResult>& cuts = stillness.cuts;
  const CutResult& worst = cuts[stillness.worst_cut];
  check.value = stillness.worst_drift_mm.value;
  check.u = check.guard = stillness.worst_drift_mm.U;
  check.chance_beyond = stillness.chance_beyond;
  decide(check);
  check.subject = nameOf(worst.unit, worst.entity);
  check.where = farthestFrame(worst, 0.0);
  check.explanation = fmt::format(
      "Of {} cuts that show x, the spot drifted most against the sheet in the one of {} at {:.3f} s: "
      "{:+.4f} mm over "
      "{:.0f} ms, standard uncertainty {:.4f} mm.",
      judged, check.subject, worst.start_s, worst.drift_mm,
      1e3 * (worst.time_s.back() - worst.time_s.front()), worst.drift_sigma_mm);
  if (judged < cuts.size()) {
    check.explanation += fmt::format(
        " {} cuts run along x, are shorter than {} frames or are off the dieline, and "
        "cannot show it.",
        cuts.size() - judged, kMinSlopeFrames);
  }
  if (const auto lost = std::ranges::count_if(lit.frames, isLost); lost > 0)
    check.explanation += fmt::format(
        " {} frames show the spot more than {:g} mm from the line that it had followed, which is as far as "
        "lines are looked for: they tell no drift.",
        lost, kSearch_mm);
}

/// Where a spot was just lost beside a line that shows x; null if it never was.
const LitFrame* nearestLost(const LitFrames& lit) {
  const LitFrame* nearest = nullptr;
  for (const LitFrame& frame : lit.frames) {
    if (!isLost(frame) || frame.ambiguous || std::abs(frame.n_x) < kMinNormalX) continue;
    if (nearest == nullptr || std::abs(frame.deviation_mm) < std::abs(nearest->deviation_mm))
      nearest = &frame;
  }
  return nearest;
}

/// The least that a spot moved which lay on its line in one frame of a run, and was lost in another.
void leastMotion(const LitFrame& lost, Check& check) {
  check.value = kSearch_mm - kReach_mm;
  check.u = check.guard = 2.0 * std::numbers::sqrt2 * lost.sigma_mm;
  check.chance_beyond = kNan;
  check.subject = nameOf(lost.unit, lost.left_entity);
  check.where = inFrame(lost);
  decideAtLeast(check);
  check.explanation = fmt::format(
      "The spot did not stay with {}: it was within {:g} mm of that line, and in the same cut, at {:.3f} s, "
      "more "
      "than {:g} mm from it along x. How far it went cannot be said: lines are looked for no farther.",
      check.subject, kReach_mm, lost.time_s, kSearch_mm);
}

/// A spot that was beside every line in most frames: proof enough that it stayed with none.
bool stayedWithNone(const LitFrames& lit, Check& check) {
  const LitFrame* farthest = nullptr;
  std::size_t off = 0;
  for (const LitFrame& frame : lit.frames) {
    if (!isOffLine(frame)) continue;
    ++off;
    if (farthest == nullptr || frame.distance_mm > farthest->distance_mm) farthest = &frame;
  }
  if (farthest == nullptr || 2 * off <= lit.frames.size()) return false;
  check.value = farthest->distance_mm;
  check.subject = nameOf(*farthest);
  check.where = inFrame(*farthest);
  decideAtLeast(check);
  check.explanation = fmt::format(
      "The spot did not stay with any line: in {} of {} frames it was more than {:.1f} mm from the dieline "
      "on the "
      "moving sheet, at {:.3f} s by {:.2f} mm or more. No cut could be followed to measure the drift "
      "itself.",
      off, lit.frames.size(), kReach_mm, farthest->time_s, farthest->distance_mm);
  return true;
}

}  // namespace

Check stillnessCheck(const Tolerances& limits, const LitFrames& lit, const Stillness& stillness) {
  Check check{
      .name = "stillness_x", .title = "Beam at rest relative to the moving sheet, along x", .unit = "mm"};
  check.limit = limits.stillness_mm;
  check.value = kNan;
  const auto judged = static_cast<std::size_t>(
      std::ranges::count_if(stillness.cuts, [](const CutResult& c) { return std::isfinite(c.drift_mm); }));
  if (judged > 0) measuredDrift(lit, stillness, judged, check);
  if (judged > 0 && check.verdict == Verdict::kFail) return check;
  if (const LitFrame* lost = nearestLost(lit); lost != nullptr) {
    leastMotion(*lost, check);
    return check;
  }
  if (judged > 0 || stayedWithNone(lit, check)) return check;
  decide(check);
  check.explanation = fmt::format(
      "None of {} cuts lets the motion along x be seen: it takes {} frames on a line that "
      "runs across the belt.",
      stillness.cuts.size(), kMinSlopeFrames);
  return check;
}

}  // namespace kerfbench::inspect::checks
