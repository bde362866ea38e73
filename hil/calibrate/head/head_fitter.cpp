// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/head_fitter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "hil/calibrate/head/spread.h"

namespace kerfbench::hil {
namespace {

constexpr int kCount = static_cast<int>(kHeadParameterCount);
constexpr std::size_t kLeastMarks = 5;
constexpr double kFewFalse = 2.0;           // Of any number of marks: two that were taken for each other.
constexpr std::size_t kMarksThatTell = 40;  // Fewer cannot tell a surface from a head.
constexpr std::size_t kMarksToBegin = 64;   // From which the others can be judged.
constexpr double kStartShare = 1e-4;  // Of the field: marks of micrometres would hold the start where it is.
constexpr int kUsualDegree = 4;
constexpr int kTellingDegree = 8;
constexpr double kUsualDecay = 0.7;
constexpr int kMostSteps = 150;
constexpr int kWholeSteps = 20;
constexpr double kSettled = 1e-3;       // Of a tolerance,
constexpr double kLastStep = 3.0;       // Of what is enough.
constexpr double kNearlySettled = 0.1;  // and where it is only about false marks.
constexpr const char* kNoConvergence =
    "the fit does not converge: are all marks of one head, one field and one sheet, and the design its own?";
constexpr int kMostPasses = 30;
constexpr int kPassesToReturn = 10;  // Later no mark comes back, so that the set must settle.
constexpr int kMostIterations = 50;
constexpr int kRoughIterations = 5;
constexpr double kFarInMisses = 10.0;     // Of the median mark: such a mark is of another place.
constexpr double kFarInSigmas = 8.0;      // Of the median mark under Cauchy's loss.
constexpr double kWorstShare = 0.25;      // Of the worst distance²: those are rejected together.
constexpr double kAreaMargin = 0.03;      // A table has one of 0.02.
constexpr double kMostTolerances = 3.0;   // Of so many parameters all are that far off never.
constexpr double kNoiseScaledAt = 2.326;  // 1 % of a normal variable lie beyond.
constexpr double kHeldShare = 1.0 / 3.0;
constexpr double kMixedCorrelation = 0.7;

Eigen::Matrix2d whiteningOf(const Eigen::Matrix2d& covariance) {
  return covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity());
}

/// `most` of the marks or all, by the golden section: in rows they come in order, and none may be favoured.
std::vector<WeighedMark> spreadOver(const std::vector<WeighedMark>& marks, std::size_t most) {
  if (marks.size() <= most) return marks;
  const double share = static_cast<double>(most) / static_cast<double>(marks.size());
  std::vector<WeighedMark> some;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double turns = std::numbers::phi * static_cast<double>(i);
    if (turns - std::floor(turns) < share) some.push_back(marks[i]);
  }
  return some;
}

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
  } else if (prior_) {
    const int degree = degreeFor(usedCount());
    prior_ = surfaceThatTheMarksWant(degree);
    settle(degree, kSettled);
  } else {
    settle(0, kSettled);
  }
  return result();
}

void HeadFitter::weighMarks() {
  const AxisFinding axes = identifyAxes(observations_);
  if (!axes.map.asTold() && !options_.accept_axes) {
    throw HeadCalibrationError(
        axes.map.words() +
        ". A table would hide what is a fault of the wiring, of the drives' directions "
        "or of how the sheet lay under the camera: mend that, or accept the axes");
  }
  axes_ = axes.map;
  unmodelled_mm_ = options_.tolerances.unmodelled_share * areaOfAims().sizes().maxCoeff();
  for (const HeadObservation& o : observations_) {
    Eigen::Matrix2d noise = o.covariance_mm2;
    if (options_.round_steps) {
      const Eigen::Matrix2d turned = axes_.matrix();
      noise += turned * nominal_.roundingCovariance_mm2(o.aim_W_mm) * turned.transpose();
    }
    noise_mm2_.push_back(noise);
    marks_.push_back({axes_.matrix() * nominal_.angles_rad(o.aim_W_mm), o.measured_W_mm, whiteningOf(noise)});
  }
}

void HeadFitter::dropFarMarks() {
  std::vector<Eigen::Vector2d> off(marks_.size(), Eigen::Vector2d::Zero());
  std::vector<double> x, y, distances;
  const auto here = landings(design_, tolerances_, scaled_, marks_);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    used_[i] = here[i].has_value();
    if (!used_[i]) continue;
    off[i] = marks_[i].measured_W_mm - *here[i];
    x.push_back(off[i].x());
    y.push_back(off[i].y());
  }
  if (x.empty()) throw HeadCalibrationError("no mark can be reached by this head");
  const Eigen::Vector2d middle(medianOf(x), medianOf(y));
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (used_[i]) distances.push_back((off[i] - middle).norm());
  }
  const double far_mm = kFarInMisses * medianOf(distances);
  for (std::size_t i = 0; i < marks_.size(); ++i) used_[i] = used_[i] && (off[i] - middle).norm() <= far_mm;
  refuseTooMany();
}

void HeadFitter::fitRobustly() {
  const std::vector<WeighedMark> marks = usedMarks();
  const std::vector<WeighedMark> some = spreadOver(marks, kMarksToBegin);
  double last = INFINITY;
  bool converged = false;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::vector<double> distances = distancesFrom(design_, tolerances_, scaled_, some);
    const double scale = std::max(1.0, medianOf(distances) / std::sqrt(kMedianChiSquare2));
    if (scale >= 0.5 * last) break;
    last = scale;
    const ModelSolution solution =
        solveModel(design_, tolerances_, scaled_, some, 2.0 * scale, kRoughIterations);
    scaled_ = solution.scaled;
    converged = solution.converged;
  }
  const std::vector<double> distances = distancesFrom(design_, tolerances_, scaled_, marks);
  const double scale = std::max(1.0, medianOf(distances) / std::sqrt(kMedianChiSquare2));
  std::size_t k = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i]) used_[i] = distances[k++] <= kFarInSigmas * scale;
  }
  refuseTooMany();
  if (converged) return;
  // However far this gets, solve() goes on from there and tells whether it settles.
  scaled_ =
      solveModel(design_, tolerances_, scaled_, spreadOver(usedMarks(), kMarksToBegin), 0.0, kMostIterations)
          .scaled;
}

std::vector<WeighedMark> HeadFitter::usedMarks() const {
  const double wide_mm = std::max(unmodelled_mm_, kStartShare * areaOfAims().sizes().maxCoeff());
  const Eigen::Matrix2d unmodelled = Eigen::Matrix2d::Identity() * wide_mm * wide_mm;
  std::vector<WeighedMark> marks;
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (!used_[i]) continue;
    marks.push_back(marks_[i]);
    marks.back().whitening_1_mm = whiteningOf(noise_mm2_[i] + unmodelled);
  }
  return marks;
}

std::size_t HeadFitter::usedCount() const {
  return static_cast<std::size_t>(std::ranges::count(used_, true));
}

void HeadFitter::reachRim() {
  if (options_.field_W_mm.isEmpty()) return;
  std::vector<Eigen::Vector2d> rim_W_mm;
  std::vector<WeighedMark> aims;
  for (const Eigen::Vector2d& share :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.5, 0.0), Eigen::Vector2d(1.0, 0.0),
        Eigen::Vector2d(0.0, 0.5), Eigen::Vector2d(1.0, 0.5), Eigen::Vector2d(0.0, 1.0),
        Eigen::Vector2d(0.5, 1.0), Eigen::Vector2d(1.0, 1.0)}) {
    const Eigen::AlignedBox2d& field = options_.field_W_mm;
    rim_W_mm.emplace_back(field.min() + share.cwiseProduct(field.sizes()));
    const Eigen::Vector2d aim_W_mm = axes_.matrix().transpose() * rim_W_mm.back();
    aims.emplace_back().angles_rad = axes_.matrix() * nominal_.angles_rad(aim_W_mm);
  }
  const auto here = landings(design_, tolerances_, scaled_, aims);
  for (std::size_t i = 0; i < aims.size(); ++i) {
    if (here[i]) reach_mm_.extend(axes_.matrix().transpose() * (2.0 * rim_W_mm[i] - *here[i]));
  }
}

Eigen::AlignedBox2d HeadFitter::areaOfAims() const {
  Eigen::AlignedBox2d area = options_.field_W_mm.merged(reach_mm_);
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i]) area.extend(observations_[i].aim_W_mm);
  }
  const Eigen::Vector2d margin = kAreaMargin * area.sizes();
  return {area.min() - margin, area.max() + margin};
}

void HeadFitter::linearise() {
  const auto here = modelled(design_, tolerances_, scaled_, marks_);
  rows_.resize(2 * static_cast<Eigen::Index>(marks_.size()), Eigen::NoChange);
  lands_.assign(marks_.size(), false);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    auto rows = rows_.middleRows<2>(2 * static_cast<Eigen::Index>(i));
    rows.setZero();
    lands_[i] = here[i].lands;
    if (!lands_[i]) continue;
    const Eigen::Vector2d reading_mm = marks_[i].measured_W_mm - here[i].p_W_mm + here[i].by_scaled * scaled_;
    rows.leftCols<kCount>() = marks_[i].whitening_1_mm * here[i].by_scaled;
    rows.col(kCount) = marks_[i].whitening_1_mm * reading_mm;
  }
}

void HeadFitter::gather(const SmoothBasis& basis) {
  const auto n = static_cast<Eigen::Index>(usedCount());
  std::vector<Eigen::Matrix2d> whitenings;
  RowMatrix values(n, prior_ ? basis.size() : 0);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (!used_[i]) continue;
    if (prior_) {
      values.row(static_cast<Eigen::Index>(whitenings.size())) =
          basis_values_.row(static_cast<Eigen::Index>(i)).head(basis.size());
    }
    whitenings.push_back(marks_[i].whitening_1_mm);
  }
  gathered_.emplace(std::move(whitenings), std::move(values));
}

WhitenedRows HeadFitter::usedRows() const {
  WhitenedRows used(2 * static_cast<Eigen::Index>(usedCount()), kCount + 1);
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (!used_[i]) continue;
    used.middleRows<2>(next) = rows_.middleRows<2>(2 * static_cast<Eigen::Index>(i));
    next += 2;
  }
  return used;
}

void HeadFitter::relinearise() {
  linearise();
  gathered_->linearise(usedCount() == used_.size() ? rows_ : usedRows());
}

/// Gauss and Newton: the surface is linear, and the model nearly so from where Ceres left it. It must settle
/// in the parameters, not only on the sheet: what the marks hold badly bends, and the covariance holds at its
/// own place alone.
void HeadFitter::solve(double settled) {
  gather(*basis_);
  double last = 0.0;
  for (int pass = 0; pass < kMostSteps; ++pass) {
    relinearise();
    joint_ = solveJoint(*gathered_, *basis_, prior_, false);
    const HeadVector step = joint_.unknowns.head<kCount>() - scaled_;
    // What the marks hold badly may swing to and fro; half steps stop that.
    scaled_ += pass < kWholeSteps ? step : HeadVector(0.5 * step);
    const double size = step.cwiseAbs().maxCoeff();
    const double next = size * std::min(1.0, size / last);  // If it goes on as it came.
    last = size;
    const double enough = pass + 1 < kMostSteps ? settled : std::max(settled, kNearlySettled);
    // The covariance is that of the place before the last step.
    if (next > enough || size > kLastStep * enough) continue;
    joint_ = solveJoint(*gathered_, *basis_, prior_, true);
    return;
  }
  throw HeadCalibrationError(kNoConvergence);
}

void HeadFitter::predictMarks(Eigen::VectorXd& residuals, Eigen::MatrixXd& modes) const {
  const auto root = joint_.covariance_root.transpose().triangularView<Eigen::Lower>();
  if (!prior_) {
    residuals = rows_.col(kCount) - rows_.leftCols<kCount>() * joint_.unknowns;
    modes = root * rows_.leftCols<kCount>().transpose();
    return;
  }
  const Eigen::Index m = basis_values_.cols();
  Eigen::MatrixXd columns(kCount + 2 * m, rows_.rows());
  columns.topRows<kCount>() = rows_.leftCols<kCount>().transpose();
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    const auto mark = static_cast<Eigen::Index>(i);
    const Eigen::Matrix2d& w = marks_[i].whitening_1_mm;
    for (Eigen::Index k = 0; k < 2; ++k) {
      auto surface = columns.col(2 * mark + k).tail(2 * m);
      surface.head(m) = w(k, 0) * basis_values_.row(mark).transpose();
      surface.tail(m) = w(k, 1) * basis_values_.row(mark).transpose();
    }
  }
  residuals = rows_.col(kCount) - columns.transpose() * joint_.unknowns;
  modes = root * columns;
}

bool HeadFitter::judge(bool may_return) {
  std::vector<double> distances;
  noise_chi2_ = 0.0;
  noise_freedom_ = 0.0;
  // Of residual and modes, a column for each row of a mark.
  Eigen::MatrixXd modes;
  Eigen::VectorXd residuals;
  predictMarks(residuals, modes);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    HeadMarkFinding& finding = findings_[i];
    const auto row = 2 * static_cast<Eigen::Index>(i);
    const Eigen::Vector2d residual = residuals.segment<2>(row);
    const double across = modes.col(row).dot(modes.col(row + 1));
    Eigen::Matrix2d predicted;
    predicted << modes.col(row).squaredNorm(), across, across, modes.col(row + 1).squaredNorm();
    finding.residual_mm = marks_[i].whitening_1_mm.inverse() * residual;
    // Of a mark that was used the residual is smaller than what the others would leave: by leverage.
    const double sign = used_[i] ? -1.0 : 1.0;
    finding.distance2 =
        lands_[i] ? distance2(residual, Eigen::Matrix2d::Identity() + sign * predicted) : INFINITY;
    if (!used_[i]) continue;
    distances.push_back(finding.distance2);
    noise_chi2_ += residual.squaredNorm();
    noise_freedom_ += 2.0 - predicted.trace();
  }
  const double scale2 = std::max(1.0, medianOf(distances) / kMedianChiSquare2);
  const double limit =
      scale2 * chiSquare2Above(options_.rejection_chance / static_cast<double>(marks_.size()));
  const double worst = *std::ranges::max_element(distances);
  bool changed = false;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    const double d2 = findings_[i].distance2;
    const bool use = used_[i] ? d2 <= limit || d2 < kWorstShare * worst : d2 <= limit && may_return;
    changed = changed || use != used_[i];
    used_[i] = use;
  }
  return changed;
}

void HeadFitter::settle(int degree, double settled) {
  for (int pass = 0; pass < kMostPasses; ++pass) {
    setBasis(degree);
    solve(settled);
    if (!judge(pass < kPassesToReturn)) return;
    refuseTooMany();
  }
  throw HeadCalibrationError("the marks contradict each other: no set of them agrees on a head");
}

void HeadFitter::scaleTolerances() {
  const double factor = toleranceFactor(*gathered_, *basis_, prior_);
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
  rows_.leftCols<kCount>() *= factor;
}

void HeadFitter::setBasis(int degree) {
  const Eigen::AlignedBox2d area = areaOfAims();
  if (basis_ && basis_->degree() == degree && basis_->area_mm().isApprox(area)) return;
  basis_ = SmoothBasis(area, degree);
  basis_values_.resize(static_cast<Eigen::Index>(observations_.size()), basis_->size());
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    basis_values_.row(static_cast<Eigen::Index>(i)) = basis_->at(observations_[i].aim_W_mm).at.transpose();
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
  setBasis(degree);
  // Rows as for the last step: it has settled nearly. Whether there is a surface shows in its lower degrees.
  const SmoothBasis lower(basis_->area_mm(), std::min(degree, kTellingDegree));
  gather(lower);
  gathered_->linearise(usedRows());
  const std::vector<double> decays = promisingDecays(*gathered_, lower);
  if (decays.empty()) return std::nullopt;
  gather(*basis_);
  gathered_->linearise(usedRows());
  return bestSurface(*gathered_, *basis_, decays);
}

void HeadFitter::refuseTooMany() const {
  const std::size_t rejected = used_.size() - usedCount();
  const double most = options_.most_false_share * static_cast<double>(used_.size());
  if (static_cast<double>(rejected) <= std::max(kFewFalse, most) && usedCount() >= kLeastMarks) return;
  std::string text = fmt::format("{} of {} marks do not fit to the others", rejected, used_.size());
  std::size_t told = 0;
  for (std::size_t i = 0; i < used_.size() && told < 10; ++i) {
    if (used_[i]) continue;
    const HeadObservation& o = observations_[i];
    text += fmt::format("\n{} aimed at ({:.3f}, {:.3f}) was measured at ({:.3f}, {:.3f}) mm",
                        o.mark ? fmt::format("mark {}", *o.mark) : "a mark", o.aim_W_mm.x(), o.aim_W_mm.y(),
                        o.measured_W_mm.x(), o.measured_W_mm.y());
    ++told;
  }
  if (told < rejected) text += fmt::format("\nand {} more", rejected - told);
  throw HeadCalibrationError(text);
}

HeadFit HeadFitter::result() const {
  HeadFit fit(nominal_, design_);
  fit.axes_ = axes_;
  fit.departures_ = tolerances_.cwiseProduct(scaled_);
  if (prior_) {
    const Eigen::Index m = basis_->size();
    fit.surface_ = HeadSurface{*basis_, prior_->amplitude_mm, prior_->decay, prior_->evidence};
    fit.coefficients_mm_.resize(m, 2);
    fit.coefficients_mm_ << joint_.unknowns.segment(kCount, m), joint_.unknowns.tail(m);
  }
  fit.marks_ = findings_;
  for (std::size_t i = 0; i < used_.size(); ++i) fit.marks_[i].used = used_[i];
  setNoiseRatio(fit);
  fit.covariance_root_ = joint_.covariance_root * (fit.noise_scaled_ ? fit.noise_ratio_ : 1.0);
  fit.covariance_root_.topRows(kCount) = tolerances_.asDiagonal() * fit.covariance_root_.topRows(kCount);
  reportParameters(fit);
  return fit;
}

void HeadFitter::setNoiseRatio(HeadFit& fit) const {
  if (noise_freedom_ < 1.0) return;  // Nothing left to tell it from.
  fit.noise_ratio_ = std::sqrt(noise_chi2_ / noise_freedom_);
  fit.noise_scaled_ = noise_chi2_ > chiSquareAbove(noise_freedom_, kNoiseScaledAt);
}

void HeadFitter::reportParameters(HeadFit& fit) const {
  const Eigen::MatrixXd root = fit.covariance_root_.topRows(kHeadParameterCount);
  const Eigen::MatrixXd covariance = root * root.transpose();
  const Eigen::VectorXd sigmas = covariance.diagonal().cwiseSqrt();
  for (std::size_t k = 0; k < kHeadParameterCount; ++k) {
    const auto which = static_cast<HeadParameter>(k);
    if (!actsOn(which, design_)) continue;
    const auto row = static_cast<Eigen::Index>(k);
    HeadParameterFinding finding{which, fit.departures_[row], sigmas[row], tolerances_[row], false, {}};
    finding.held = finding.sigma < kHeldShare * finding.prior_sigma;
    double strongest = kMixedCorrelation;
    for (Eigen::Index other = 0; !finding.held && other < covariance.cols(); ++other) {
      const double correlation = std::abs(covariance(row, other)) / (sigmas[row] * sigmas[other]);
      if (other == row || correlation <= strongest) continue;
      strongest = correlation;
      finding.mixed_with = static_cast<HeadParameter>(other);
    }
    fit.parameters_.push_back(finding);
  }
}

}  // namespace kerfbench::hil
