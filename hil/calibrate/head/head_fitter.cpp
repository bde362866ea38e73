// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/head_fitter.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/surface_evidence.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::size_t kMarksThatTell = 40;  // Least marks that tell a surface from a head.
constexpr int kUsualDegree = 4;
constexpr int kTellingDegree = 8;
constexpr double kUsualDecay = 0.7;
constexpr int kWholeSteps = 20;
constexpr int kDampedSteps = 200;
constexpr double kFirstDamping = 1.0;  // Damping as strong as the tolerances.
constexpr double kLeastDamping = 0.01, kDampingFactor = 10.0;
constexpr double kGoodShare = 0.75, kPoorShare = 0.25;  // Gain of a step over the gain that it promised.
constexpr double kSettled = 1e-3;       // Size in tolerances below which the next step need not be taken.
constexpr double kLastStep = 3.0;       // Largest size of the last step over kSettled.
constexpr double kNearlySettled = 0.1;  // kSettled of a fit that only looks for false marks.
constexpr const char* kNoConvergence =
    "the fit does not converge: are all marks of one head, one field and one sheet, and the design its own?";
constexpr int kMostPasses = 30;
constexpr int kPassesToReturn = 10;  // Passes in which a rejected mark may return; the set must settle later.
/// Largest scale of the tolerances by few marks; more means false marks.
constexpr double kMostTolerances = 3.0;

}  // namespace

HeadFitter::HeadFitter(std::span<const HeadObservation> observations, const NominalHead& nominal,
                       const HeadDesign& design, const HeadFitOptions& options)
    : observations_(observations),
      nominal_(nominal),
      design_(design),
      options_(options),
      tolerances_(options.tolerances.sigmas(design)),
      used_(observations.size(), true),
      findings_(observations.size()) {}

HeadFit HeadFitter::fit() {
  weighMarks();
  dropFarMarks();
  fitRobustly();
  reachRim();
  prior_ = options_.most_surface_degree > 0 ? std::optional(SurfacePrior{unmodelled_mm_, kUsualDecay, 0.0})
                                            : std::nullopt;
  const bool few = usedCount() < kMarksThatTell;
  settle(std::min(options_.most_surface_degree, kUsualDegree), few ? kSettled : kNearlySettled);
  scaleTolerances();
  if (few) {
    settle(std::min(options_.most_surface_degree, kUsualDegree), kSettled);
  } else {
    const int degree = degreeFor(usedCount());
    if (prior_) prior_ = surfaceThatTheMarksWant(degree);
    settle(prior_ ? degree : 0, kSettled);
  }
  return result();
}

std::size_t HeadFitter::usedCount() const {
  return static_cast<std::size_t>(std::ranges::count(used_, true));
}

void HeadFitter::linearise() {
  const auto here = modelled(design_, tolerances_, scaled_, marks_);
  linearised_at_ = scaled_;
  rows_.resize(2 * static_cast<Eigen::Index>(marks_.size()), Eigen::NoChange);
  lands_.assign(marks_.size(), false);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    auto rows = rows_.middleRows<2>(2 * static_cast<Eigen::Index>(i));
    rows.setZero();
    lands_[i] = here[i].lands;
    if (!lands_[i]) continue;
    rows.leftCols<kHeadColumns>() = marks_[i].whitening_1_mm * here[i].by_scaled;
    rows.col(kHeadColumns) = marks_[i].whitening_1_mm * (marks_[i].measured_W_mm - here[i].p_W_mm);
  }
}

void HeadFitter::gather() {
  if (gathered_ && gathered_->functions() == (prior_ ? basis_->size() : 0)) return;
  const auto n = static_cast<Eigen::Index>(usedCount());
  std::vector<Eigen::Matrix2d> whitenings;
  RowMatrix values(n, prior_ ? basis_->size() : 0);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (!used_[i]) continue;
    if (prior_) {
      values.row(static_cast<Eigen::Index>(whitenings.size())) =
          basis_values_.row(static_cast<Eigen::Index>(i));
    }
    whitenings.push_back(marks_[i].whitening_1_mm);
  }
  gathered_.emplace(std::move(whitenings), std::move(values), usedOf(shared_));
}

template <typename Rows>
Rows HeadFitter::usedOf(const Rows& rows) const {
  Rows used(2 * static_cast<Eigen::Index>(usedCount()), rows.cols());
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (!used_[i]) continue;
    used.template middleRows<2>(next) = rows.template middleRows<2>(2 * static_cast<Eigen::Index>(i));
    next += 2;
  }
  return used;
}

void HeadFitter::relinearise() {
  linearise();
  gathered_->linearise(usedCount() == used_.size() ? rows_ : usedOf(rows_), -linearised_at_);
}

/// Gauss and Newton: the surface is linear, and the model nearly so from where the robust start left it. It
/// must settle in the parameters, not only on the sheet: what the marks hold badly bends, and the covariance
/// holds at its own place alone.
bool HeadFitter::solve(double settled) {
  const HeadVector start = scaled_;
  gather();
  solver_.emplace(*gathered_, prior_ ? sigmasOf(*prior_, *basis_) : Eigen::VectorXd());
  double last = 0.0;
  for (int pass = 0; pass < kWholeSteps; ++pass) {
    relinearise();
    const HeadVector step = solver_->model().step();
    const double size = step.cwiseAbs().maxCoeff();
    const double next = size * std::min(1.0, size / last);  // If it goes on as it came.
    last = size;
    scaled_ += step;
    // The covariance is that of the place before the last step.
    if (next > settled || size > kLastStep * settled) continue;
    joint_ = solver_->solve();
    return true;
  }
  scaled_ = start;
  relinearise();
  joint_ = solver_->solve();
  return false;
}

/// Levenberg and Marquardt: each step makes it better, and is as short as that takes.
void HeadFitter::solveDamped(double settled) {
  ModelInformation here = solver_->model();
  double damping = kFirstDamping;
  for (int pass = 0; pass < kDampedSteps; ++pass) {
    const HeadVector before = scaled_;
    const HeadVector step = here.step(damping);
    // A whole step is at most so much longer.
    if ((1.0 + damping) * step.norm() <= settled) {
      joint_ = solver_->solve();
      scaled_ += joint_.unknowns.head<kHeadColumns>();
      return;
    }
    const double misfit = here.misfit(HeadVector::Zero());
    scaled_ += step;
    relinearise();
    const ModelInformation there = solver_->model();
    const double gained = usedLand() ? misfit - there.misfit(HeadVector::Zero()) : -INFINITY;
    const double promised = misfit - here.misfit(step);
    if (gained > kGoodShare * promised) damping = std::max(kLeastDamping, damping / kDampingFactor);
    if (gained < kPoorShare * promised) damping *= kDampingFactor;
    if (gained > 0.0) {
      here = there;
      continue;
    }
    scaled_ = before;
    relinearise();
  }
  throw HeadCalibrationError(kNoConvergence);
}

bool HeadFitter::usedLand() const {
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i] && !lands_[i]) return false;
  }
  return true;
}

void HeadFitter::settle(int degree, double settled) {
  for (int pass = 0; pass < kMostPasses; ++pass) {
    setBasis(degree);
    // A false mark that is still in may bend the model by tolerances, beyond what steps follow: it must go
    // first, by what the marks show at the start. Only if none does is it the head that bends.
    if (!solve(settled)) {
      if (judge(false)) {
        refuseTooMany();
        continue;
      }
      solveDamped(settled);
    }
    if (!judge(pass < kPassesToReturn)) return;
    refuseTooMany();
  }
  throw HeadCalibrationError("the marks contradict each other: no set of them agrees on a head");
}

void HeadFitter::scaleTolerances() {
  const double factor = toleranceFactor(solver_->model());
  if (usedCount() < kMarksThatTell && factor > kMostTolerances) {
    throw HeadCalibrationError(
        fmt::format("by these {} marks the head would be {:.0f} times as far from its drawing as it may be: "
                    "false marks among so few cannot be told, unless the design is not its own. Mark more, "
                    "{} at least",
                    usedCount(), factor, kMarksThatTell));
  }
  tolerance_factor_ *= factor;
  tolerances_ *= factor;
  scaled_ /= factor;
  linearised_at_ /= factor;
  rows_.leftCols<kHeadColumns>() *= factor;
}

void HeadFitter::setBasis(int degree) {
  const Eigen::AlignedBox2d area = areaOfAims();
  if (basis_ && basis_->degree() == degree && basis_->area_mm().isApprox(area)) return;
  forgetGathered();
  basis_ = SmoothBasis(area, degree);
  basis_values_.resize(static_cast<Eigen::Index>(observations_.size()), basis_->size());
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    basis_values_.row(static_cast<Eigen::Index>(i)) = basis_->valuesAt(observations_[i].aim_W_mm).transpose();
  }
}

/// The highest degree that has no more than one function for every two marks.
int HeadFitter::degreeFor(std::size_t marks) const {
  int degree = 0;
  while (degree < options_.most_surface_degree && (degree + 2) * (degree + 3) <= static_cast<int>(marks))
    ++degree;
  return degree;
}

std::optional<SurfacePrior> HeadFitter::surfaceThatTheMarksWant(int degree) {
  // Rows as for the last step: it has settled nearly. Whether there is a surface shows in its lower degrees.
  setBasis(std::min(degree, kTellingDegree));
  gather();
  gathered_->linearise(usedOf(rows_), -linearised_at_);
  const std::vector<double> decays = promisingDecays(*gathered_, *basis_);
  if (decays.empty()) return std::nullopt;
  setBasis(degree);
  gather();
  gathered_->linearise(usedOf(rows_), -linearised_at_);
  return bestSurface(*gathered_, *basis_, decays);
}

}  // namespace kerfbench::calibrate
