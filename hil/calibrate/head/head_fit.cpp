// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/head_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/LU>

#include "hil/calibrate/head/head_fitter.h"
#include "hil/calibrate/head/spread.h"

namespace kerfbench::calibrate {
namespace {

std::string faultsOf(std::span<const HeadObservation> observations) {
  std::string faults;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const HeadObservation& o = observations[i];
    if (isMeasured(o)) continue;
    faults += fmt::format("{} is not finite or has no positive covariance\n",
                          o.mark ? fmt::format("mark {}", *o.mark) : fmt::format("observation {}", i));
  }
  return faults;
}

void check(const HeadFitOptions& options, const HeadDesign& design) {
  std::string faults;
  const HeadVector sigmas = options.tolerances.sigmas(design);
  if (!sigmas.allFinite() || !(sigmas.minCoeff() > 0.0) || !(options.tolerances.unmodelled_share > 0.0))
    faults += "options.tolerances must be above 0; ";
  if (!(options.rejection_chance > 0.0 && options.rejection_chance < 1.0))
    faults += "options.rejection_chance must be in (0, 1); ";
  if (!(options.most_false_share >= 0.0 && options.most_false_share < 0.5))
    faults += "options.most_false_share must be in [0, 0.5); ";
  if (options.most_surface_degree < 0 || options.most_surface_degree > 30)
    faults += "options.most_surface_degree must be 0 … 30; ";
  if (!faults.empty()) throw std::invalid_argument(faults.substr(0, faults.size() - 2));
}

}  // namespace

std::size_t HeadFit::rejected() const {
  return static_cast<std::size_t>(std::ranges::count(marks_, false, &HeadMarkFinding::used));
}

std::optional<HeadFit::Spot> HeadFit::spotOf(const Eigen::Vector2d& aim_W_mm) const {
  const Eigen::Matrix2d wired = axes_.matrix();
  const auto traced = model_.angleSlopesAt(wired * nominal_.angles_rad(aim_W_mm), departures_);
  if (!traced) return std::nullopt;
  Spot spot{traced->p_W_mm, traced->by_angles * wired * nominal_.slopes_rad_mm(aim_W_mm)};
  if (surface_) {
    const SmoothBasis::Values values = surface_->basis.at(aim_W_mm);
    spot.p_W_mm += coefficients_mm_.transpose() * values.at;
    spot.by_aim += coefficients_mm_.transpose() * values.by_p;
  }
  return spot;
}

std::optional<Eigen::Matrix2Xd> HeadFit::modesAt(const Eigen::Vector2d& aim_W_mm) const {
  const auto traced = model_.departureSlopesAt(axes_.matrix() * nominal_.angles_rad(aim_W_mm), departures_);
  if (!traced) return std::nullopt;
  const Eigen::VectorXd basis = surface_ ? surface_->basis.valuesAt(aim_W_mm) : Eigen::VectorXd();
  return rowsOf(traced->by_departures, basis) * covariance_root_;
}

std::optional<HeadFit::ErrorModes> HeadFit::errorModesAt(const Eigen::Vector2d& aim_W_mm) const {
  const auto traced = model_.departureSlopesAt(axes_.matrix() * nominal_.angles_rad(aim_W_mm), departures_);
  if (!traced) return std::nullopt;
  const Eigen::VectorXd basis = surface_ ? surface_->basis.valuesAt(aim_W_mm) : Eigen::VectorXd();
  const Eigen::Matrix2Xd rows = rowsOf(traced->by_departures, basis);
  return ErrorModes{rows * root_by_marks_, rows * root_by_tolerances_, rows * root_by_surface_};
}

std::optional<Eigen::Matrix2d> HeadFit::covarianceAt_mm2(const Eigen::Vector2d& aim_W_mm) const {
  const auto modes = modesAt(aim_W_mm);
  if (!modes) return std::nullopt;
  return *modes * modes->transpose();
}

std::optional<Eigen::Vector2d> HeadFit::aimFor(const Eigen::Vector2d& p_W_mm) const {
  constexpr int kMostSteps = 50;
  constexpr double kClose_mm = 1e-9;
  Eigen::Vector2d aim_W_mm = axes_.matrix().transpose() * p_W_mm;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto spot = spotOf(aim_W_mm);
    if (!spot) return std::nullopt;
    const Eigen::Vector2d miss_mm = p_W_mm - spot->p_W_mm;
    if (miss_mm.norm() <= kClose_mm) return aim_W_mm;
    aim_W_mm += spot->by_aim.inverse() * miss_mm;
    if (!aim_W_mm.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

HeadFit fitHead(std::span<const HeadObservation> observations, const NominalHead& nominal,
                const HeadDesign& design, const HeadFitOptions& options) {
  check(nominal);
  check(design);
  check(options, design);
  const std::string faults = faultsOf(observations);
  if (!faults.empty()) throw HeadCalibrationError(faults.substr(0, faults.size() - 1));
  return HeadFitter(observations, nominal, design, options).fit();
}

}  // namespace kerfbench::calibrate
