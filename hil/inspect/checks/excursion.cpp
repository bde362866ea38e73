// SPDX-License-Identifier: Apache-2.0
// How far the beam strays from its mean place on the moving sheet, along x, during a cut, and how far off
// that place is. A belt whose speed changes leaves a beam that goes by the mean speed behind and lets it
// catch up: a drift from end to end need not show it.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/cut_readings.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/deviation/worst_deviation.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr std::uint64_t kExcursionSeed = 0x657863757273696fULL;

constexpr double kPlaceInPixel_px = 0.006;

/// Mean of the residuals, with equal weights; its uncertainty by noise that is correlated from frame to
/// frame, by the modes of the camera, which shift neighbouring places alike, and by the place within the
/// pixel.
void measureOffset(const CutReadings& readings, double q, double by_pixel_mm, CutResult& cut) {
  const auto n = static_cast<double>(cut.residual_mm.size());
  double sum_mm = 0.0;
  double variance = 0.0;
  double behind = 0.0;
  for (std::size_t i = 0; i < cut.residual_mm.size(); ++i) {
    sum_mm += cut.residual_mm[i];
    behind *= q;
    variance += readings.sigma_mm[i] * (readings.sigma_mm[i] + 2.0 * behind);
    behind += readings.sigma_mm[i];
  }
  cut.offset_mm = sum_mm / n;
  const double by_noise_mm = std::sqrt(std::max(variance, 0.0)) / n;
  const double by_camera_mm = readings.columns > 0 ? readings.shared().colwise().mean().norm() : 0.0;
  cut.offset_sigma_mm = std::hypot(by_noise_mm, by_camera_mm, by_pixel_mm);
}

/// The residuals of a cut, less their mean.
ReadingLine aboutMean(const CutResult& cut, const CutReadings& readings, double q) {
  std::vector<double> residual_mm = cut.residual_mm;
  for (double& x : residual_mm) x -= cut.offset_mm;
  const Eigen::MatrixXd as_read = readings.shared();
  Eigen::MatrixXd shared = as_read;
  if (shared.cols() > 0) shared.rowwise() -= as_read.colwise().mean();
  return lineOf(residual_mm, readings.sigma_mm, shared, q);
}

}  // namespace

double placeInPixelSigma_mm(const Evidence& evidence) {
  return evidence.spot_calibration ? kPlaceInPixel_px * evidence.spot_calibration->pitchMm() : 0.0;
}

Whereabouts farthestFrame(const CutResult& cut, double from_mm) {
  Whereabouts where = onLine(cut.unit, cut.entity);
  const auto farthest = std::ranges::max_element(
      cut.residual_mm, {}, [from_mm](double residual_mm) { return std::abs(residual_mm - from_mm); });
  if (farthest == cut.residual_mm.end()) return where;
  where.time = Whereabouts::Time::kFrame;
  where.time_s = cut.time_s[static_cast<std::size_t>(farthest - cut.residual_mm.begin())];
  return where;
}

void measureExcursions(const Evidence& evidence, const std::vector<CutReadings>& readings, double q,
                       double limit_mm, Stillness& stillness) {
  const double by_pixel_mm = placeInPixelSigma_mm(evidence);
  ErrorModel model{.lines = {},
                   .modes = readings.empty() ? 0 : readings.front().columns,
                   .estimator_mm = by_pixel_mm,
                   .trends = true};
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < stillness.cuts.size(); ++i) {
    if (!std::isfinite(stillness.cuts[i].drift_mm)) continue;
    measureOffset(readings[i], q, by_pixel_mm, stillness.cuts[i]);
    of.push_back(i);
  }
  if (of.empty()) return;
  model.made = of.size();
  model.make = [&](std::size_t line, ErrorModel::Part /*part*/) {
    return aboutMean(stillness.cuts[of[line]], readings[of[line]], q);
  };
  const std::vector<LineKind> kinds(of.size());
  const DeviationResult found = measureDeviations(model, kinds, limit_mm, kExcursionSeed, evidence.threads);
  for (std::size_t i = 0; i < of.size(); ++i) {
    stillness.cuts[of[i]].excursion_mm = found.lines[i].worst.value;
    stillness.cuts[of[i]].excursion_U_mm = found.lines[i].worst.U;
  }
  stillness.worst_excursion_mm = found.all.worst;
  stillness.excursion_chance_beyond = found.chance_beyond;
  stillness.worst_excursion_cut = of[found.all.line];
}

Finding excursionCheck(const Tolerances& limits, const Stillness& stillness) {
  const bool judged = std::any_of(stillness.cuts.begin(), stillness.cuts.end(),
                                  [](const CutResult& c) { return std::isfinite(c.drift_mm); });
  Check check{.name = "stillness_peak",
              .title = "Beam at one place of the moving sheet, along x, all through each cut",
              .unit = "mm"};
  if (!judged) return notJudged(check, "No cut shows x; see stillness_x.");
  const CutResult& worst = stillness.cuts[stillness.worst_excursion_cut];
  check.limit = limits.stillness_mm;
  check.value = stillness.worst_excursion_mm.value;
  check.u = check.guard = stillness.worst_excursion_mm.U;
  check.chance_beyond = stillness.excursion_chance_beyond;
  check.subject = nameOf(worst.unit, worst.entity);
  check.where = farthestFrame(worst, worst.offset_mm);
  decide(check);
  check.explanation = fmt::format(
      "In the cut of {} at {:.3f} s the spot strayed by {:.4f} mm from its mean place on the sheet, farther "
      "than in any other; that place lies {:+.4f} mm from the line, standard uncertainty {:.4f} mm.",
      check.subject, worst.start_s, check.value, worst.offset_mm, worst.offset_sigma_mm);
  if (worst.lost > 0)
    check.explanation += fmt::format(
        " {} frames of that cut show it more than {:g} mm from the line, which is as far as lines are looked "
        "for: they are left out.",
        worst.lost, kSearch_mm);
  return check;
}

}  // namespace kerfbench::inspect::checks
