// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/quick_check.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/head/spread.h"

namespace kerfbench::calibrate {
namespace {

using Six = Eigen::Matrix<double, static_cast<int>(kHeadDriftCount), 1>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kHeadDriftCount)>;

constexpr std::size_t kMostFalse = 1;  // Rejected marks with which a correction may still be said to hold.

/// What few marks say, with all that the fit and they do not know.
struct Readings {
  Eigen::VectorXd off_mm;
  Columns slopes;  ///< mm for a whole limit of each drift.
  Eigen::MatrixXd covariance_mm2;
};

Six scalesOf(const QuickCheckLimits& limits) {
  Six scales;
  scales << limits.zero_mm, limits.zero_mm, limits.gain, limits.gain, limits.turn_rad, limits.height_mm;
  return scales;
}

/// d(x, y)/d(drift) of where the beam lands.
Eigen::Matrix<double, 2, static_cast<int>(kHeadDriftCount)> slopesAt(const HeadFit& fit,
                                                                     const HeadObservation& o) {
  const Eigen::Vector2d commanded = fit.nominal().angles_rad(o.aim_W_mm);
  const auto traced = fit.model().departureSlopesAt(fit.axes().matrix() * commanded, fit.departures());
  const auto spot = fit.spotOf(o.aim_W_mm);
  if (!traced || !spot) throw HeadCalibrationError("a mark of the check is where the beam does not land");
  const auto by = [&](HeadParameter parameter) -> Eigen::Vector2d {
    return traced->by_departures.col(static_cast<Eigen::Index>(indexOf(parameter)));
  };
  // A zero in mm: the turn of the mirror that shifts the resting beam by one.
  const auto middle = fit.model().angleSlopesAt(Eigen::Vector2d::Zero(), fit.departures());
  if (!middle) throw HeadCalibrationError("the resting beam does not land");
  Eigen::Matrix<double, 2, static_cast<int>(kHeadDriftCount)> slopes;
  slopes << by(HeadParameter::kXZero) / middle->by_angles.col(0).norm(),
      by(HeadParameter::kYZero) / middle->by_angles.col(1).norm(), by(HeadParameter::kXScale),
      by(HeadParameter::kYScale), by(HeadParameter::kPlaneTurn), by(HeadParameter::kPlaneHeight);
  return slopes;
}

Readings readingsOf(const HeadFit& fit, const std::vector<HeadObservation>& marks, const Six& scales) {
  const auto n = static_cast<Eigen::Index>(marks.size());
  Readings readings{Eigen::VectorXd(2 * n), Columns(2 * n, 6), {}};
  std::vector<Eigen::Matrix2Xd> modes;
  for (Eigen::Index i = 0; i < n; ++i) {
    const HeadObservation& o = marks[static_cast<std::size_t>(i)];
    readings.slopes.middleRows<2>(2 * i) = slopesAt(fit, o) * scales.asDiagonal();
    readings.off_mm.segment<2>(2 * i) = o.measured_W_mm - fit.spotOf(o.aim_W_mm)->p_W_mm;
    modes.push_back(*fit.modesAt(o.aim_W_mm));
  }
  Eigen::MatrixXd all(2 * n, modes.front().cols());
  for (Eigen::Index i = 0; i < n; ++i) all.middleRows<2>(2 * i) = modes[static_cast<std::size_t>(i)];
  readings.covariance_mm2 = all * all.transpose();
  for (Eigen::Index i = 0; i < n; ++i) {
    const HeadObservation& o = marks[static_cast<std::size_t>(i)];
    readings.covariance_mm2.block<2, 2>(2 * i, 2 * i) +=
        o.covariance_mm2 + fit.nominal().roundingCovariance_mm2(o.aim_W_mm);
    for (Eigen::Index k = 0; k < n; ++k) {
      const HeadObservation& other = marks[static_cast<std::size_t>(k)];
      if (!o.shared || !other.shared || o.shared->sheet != other.shared->sheet) continue;
      readings.covariance_mm2.block<2, 2>(2 * i, 2 * k) +=
          o.shared->modes_mm * other.shared->modes_mm.transpose();
    }
  }
  return readings;
}

/// Least squares over some of the drifts with their priors, in units of the limits.
struct Explained {
  Six values{Six::Zero()};
  Six sigmas{Six::Zero()};
  double chi2{};  ///< What they leave, priors included.
};

Explained explain(const Readings& readings, const std::vector<std::size_t>& causes) {
  const Eigen::LLT<Eigen::MatrixXd> noise(readings.covariance_mm2);
  const Eigen::VectorXd off = noise.matrixL().solve(readings.off_mm);
  Explained explained;
  explained.chi2 = off.squaredNorm();
  if (causes.empty()) return explained;
  const auto count = static_cast<Eigen::Index>(causes.size());
  Eigen::MatrixXd columns(readings.slopes.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k)
    columns.col(k) = readings.slopes.col(static_cast<Eigen::Index>(causes[static_cast<std::size_t>(k)]));
  columns = noise.matrixL().solve(columns).eval();
  const Eigen::MatrixXd normal = columns.transpose() * columns + Eigen::MatrixXd::Identity(count, count);
  const Eigen::LLT<Eigen::MatrixXd> factor(normal);
  const Eigen::VectorXd gradient = columns.transpose() * off;
  const Eigen::VectorXd values = factor.solve(gradient);
  const Eigen::MatrixXd covariance = factor.solve(Eigen::MatrixXd::Identity(count, count));
  explained.chi2 -= gradient.dot(values);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto which = static_cast<Eigen::Index>(causes[static_cast<std::size_t>(k)]);
    explained.values[which] = values[k];
    explained.sigmas[which] = std::sqrt(covariance(k, k));
  }
  return explained;
}

/// The inverse of the normal distribution's tail by bisection: few calls, no table.
double normalAbove(double chance) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::sqrt(2.0)) > chance ? low : high) = middle;
  }
  return low;
}

/// Adds the cause that explains most, as long as it explains more than chance does in any of six.
std::vector<std::size_t> causesOf(const Readings& readings, double false_alarm) {
  const double one = normalAbove(0.5 * false_alarm / static_cast<double>(kHeadDriftCount));
  std::vector<std::size_t> causes;
  while (causes.size() < kHeadDriftCount) {
    const double before = explain(readings, causes).chi2;
    std::size_t best = kHeadDriftCount;
    double least = before - one * one;
    for (std::size_t k = 0; k < kHeadDriftCount; ++k) {
      if (std::ranges::find(causes, k) != causes.end()) continue;
      auto with = causes;
      with.push_back(k);
      const double chi2 = explain(readings, with).chi2;
      if (chi2 >= least) continue;
      least = chi2;
      best = k;
    }
    if (best == kHeadDriftCount) break;
    causes.push_back(best);
  }
  return causes;
}

/// Mark farthest from what all six causes, fitted to the others, put there; in standard deviations squared.
struct Farthest {
  std::size_t mark{};
  double distance2{};
};

Farthest farthestOf(const HeadFit& fit, const std::vector<HeadObservation>& marks, const Six& scales) {
  const Readings all = readingsOf(fit, marks, scales);
  Eigen::MatrixXd covariance = all.covariance_mm2 + all.slopes * all.slopes.transpose();
  // Leaving one out: its block of the inverse is the inverse of its covariance given all others.
  const Eigen::MatrixXd inverse =
      covariance.llt().solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
  const Eigen::VectorXd weighted = inverse * all.off_mm;
  Farthest farthest;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    const Eigen::Vector2d part = weighted.segment<2>(row);
    const double d2 = part.dot(inverse.block<2, 2>(row, row).inverse() * part);
    if (d2 > farthest.distance2) farthest = {i, d2};
  }
  return farthest;
}

void check(const QuickCheckLimits& limits) {
  const Six scales = scalesOf(limits);
  if (!scales.allFinite() || !(scales.minCoeff() > 0.0) ||
      !(limits.false_alarm > 0.0 && limits.false_alarm < 1.0))
    throw std::invalid_argument("limits of a check must be above 0, false_alarm in (0, 1)");
}

std::string wordsOf(const QuickCheckResult& result) {
  std::string words;
  for (const DriftFinding& drift : result.drifts) {
    if (!drift.changed) continue;
    words += fmt::format("{}{} changed by {:+.6f} ± {:.6f}{}", words.empty() ? "" : "; ", nameOf(drift.which),
                         drift.value, 2.0 * drift.sigma, unitOf(drift.which));
  }
  if (result.unexplained) words += (words.empty() ? "" : "; ") + std::string("something else changed too");
  if (words.empty()) words = result.holds ? "the correction holds" : "the marks contradict each other";
  if (result.rejected > 0) words += fmt::format("; {} of the marks do not fit", result.rejected);
  return words;
}

}  // namespace

std::string_view nameOf(HeadDrift drift) {
  switch (drift) {
    case HeadDrift::kZeroX:
      return "zero of x";
    case HeadDrift::kZeroY:
      return "zero of y";
    case HeadDrift::kGainX:
      return "gain of x";
    case HeadDrift::kGainY:
      return "gain of y";
    case HeadDrift::kTurn:
      return "turn of the head";
    case HeadDrift::kSheetHeight:
      return "sheet height";
  }
  return "";
}

std::string_view unitOf(HeadDrift drift) {
  switch (drift) {
    case HeadDrift::kGainX:
    case HeadDrift::kGainY:
      return "";
    case HeadDrift::kTurn:
      return " rad";
    default:
      return " mm";
  }
}

QuickCheckResult quickCheck(const HeadFit& fit, std::span<const HeadObservation> observations,
                            const QuickCheckLimits& limits) {
  check(limits);
  std::vector<HeadObservation> marks(observations.begin(), observations.end());
  for (const HeadObservation& o : marks) {
    if (!isMeasured(o))
      throw HeadCalibrationError("a mark of the check is not finite or has no positive covariance");
  }
  const Six scales = scalesOf(limits);
  QuickCheckResult result;
  while (marks.size() > kLeastMarks) {
    const Farthest farthest = farthestOf(fit, marks, scales);
    if (farthest.distance2 <= chiSquare2Above(limits.false_alarm / static_cast<double>(marks.size()))) break;
    marks.erase(marks.begin() + static_cast<std::ptrdiff_t>(farthest.mark));
    ++result.rejected;
  }
  if (marks.size() < kLeastMarks) {
    throw HeadCalibrationError(
        fmt::format("{} marks are too few for a check, it takes {}", marks.size(), kLeastMarks));
  }
  const Readings readings = readingsOf(fit, marks, scales);
  const Explained full = explain(readings, {0, 1, 2, 3, 4, 5});
  const std::vector<std::size_t> causes = causesOf(readings, limits.false_alarm);
  const Explained fewest = explain(readings, causes);
  for (std::size_t k = 0; k < kHeadDriftCount; ++k) {
    const bool changed = std::ranges::find(causes, k) != causes.end();
    const Explained& told = changed ? fewest : full;
    const auto row = static_cast<Eigen::Index>(k);
    result.drifts[k] = {static_cast<HeadDrift>(k), told.values[row] * scales[row],
                        told.sigmas[row] * scales[row], changed};
  }
  const Explained of_head = explain(readings, {0, 1, 2, 3, 4});
  for (std::size_t k = 0; k < result.of_head.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    result.of_head[k] = {static_cast<HeadDrift>(k), of_head.values[row] * scales[row],
                         of_head.sigmas[row] * scales[row], result.drifts[k].changed};
  }
  const double freedom = static_cast<double>(2 * marks.size());
  result.unexplained = fewest.chi2 > chiSquareAbove(freedom, normalAbove(limits.false_alarm));
  result.holds = causes.empty() && !result.unexplained && result.rejected <= kMostFalse;
  for (Eigen::Index i = 0; i < readings.off_mm.size(); i += 2)
    result.worst_mm = std::max(result.worst_mm, readings.off_mm.segment<2>(i).norm());
  result.words = wordsOf(result);
  return result;
}

}  // namespace kerfbench::calibrate
