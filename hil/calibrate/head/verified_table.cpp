// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/verified_table.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "hil/calibrate/head/spread.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kGoodMarkLeftOut = 0.05;  // Chance that one good mark or more of all is taken for another.
constexpr double kMostDisagreeing = 0.02;  // Share of the marks; more are no single false marks.
constexpr std::size_t kFewDisagreeing = 2;
constexpr int kSide = 21;
constexpr int kDraws = 400;
constexpr std::uint64_t kDrawSeed = 1;

/// Logarithm of the least that marks scatter by, over what is stated: a quarter. Marks that are computed
/// exactly would go to nothing.
const double kLeastMarkFactor = std::log(0.25);

/// Logarithms of the factors of tolerances, surface and marks.
using Factors = Eigen::Vector3d;
const Factors kFactorSpread(std::log(10.0), std::log(10.0), std::log(2.0));  // 1 sigma.

/// The error modes of the fit side by side: those that no factor scales first.
struct Modes {
  Eigen::Matrix2Xd columns;
  Index by_marks{}, by_tolerances{};
};

Modes modesOf(const HeadFit& fit, const Vector2d& aim_W_mm) {
  const auto modes = fit.errorModesAt(aim_W_mm);
  if (!modes)
    throw HeadCalibrationError(
        fmt::format("the beam aimed at ({:.3f}, {:.3f}) mm does not land", aim_W_mm.x(), aim_W_mm.y()));
  Modes all{{}, modes->by_marks_mm.cols(), modes->by_tolerances_mm.cols()};
  all.columns.resize(Eigen::NoChange, all.by_marks + all.by_tolerances + modes->by_surface_mm.cols());
  all.columns << modes->by_marks_mm, modes->by_tolerances_mm, modes->by_surface_mm;
  return all;
}

/// The marks in units of their own noise: two rows each, a column for each mode of the fit and, last, for
/// each error of a sheet's place.
struct WhitenedMarks {
  MatrixXd columns;
  VectorXd errors;
  Index by_marks{}, by_tolerances{}, of_fit{};
  Eigen::Matrix2d mean_covariance_mm2{Eigen::Matrix2d::Zero()};

  /// Factors of the columns.
  [[nodiscard]] VectorXd scales(const Factors& logs) const {
    VectorXd scales = VectorXd::Ones(columns.cols());
    scales.segment(by_marks, by_tolerances).setConstant(std::exp(logs[0]));
    scales.segment(by_marks + by_tolerances, of_fit - by_marks - by_tolerances)
        .setConstant(std::exp(logs[1]));
    return scales;
  }
};

WhitenedMarks marksInTheirNoise(const HeadFit& fit, std::span<const HeadObservation> marks,
                                const Modes& modes) {
  std::set<int> sheets;
  for (const HeadObservation& o : marks)
    if (o.shared) sheets.insert(o.shared->sheet);
  WhitenedMarks all;
  all.by_marks = modes.by_marks;
  all.by_tolerances = modes.by_tolerances;
  all.of_fit = modes.columns.cols();
  const auto rows = 2 * static_cast<Index>(marks.size());
  all.columns = MatrixXd::Zero(rows, all.of_fit + 3 * static_cast<Index>(sheets.size()));
  all.errors.resize(rows);
  for (Index row = 0; row < rows; row += 2) {
    const HeadObservation& o = marks[static_cast<std::size_t>(row / 2)];
    const auto own = o.covariance_mm2.llt();
    all.columns.block(row, 0, 2, all.of_fit) = own.matrixL().solve(modesOf(fit, o.aim_W_mm).columns);
    if (o.shared) {
      const auto sheet = std::distance(sheets.begin(), sheets.find(o.shared->sheet));
      all.columns.block<2, 3>(row, all.of_fit + 3 * sheet) = own.matrixL().solve(o.shared->modes_mm);
    }
    all.errors.segment<2>(row) = own.matrixL().solve(o.measured_W_mm - fit.spotOf(o.aim_W_mm).value().p_W_mm);
    all.mean_covariance_mm2 += o.covariance_mm2 / static_cast<double>(marks.size());
  }
  return all;
}

/// Marks that take part, as sums. Marks are taken out and never come back.
class Posterior {
 public:
  explicit Posterior(const WhitenedMarks& marks)
      : marks_(marks),
        gram_(marks.columns.transpose() * marks.columns),
        read_(marks.columns.transpose() * marks.errors),
        errors2_(marks.errors.squaredNorm()),
        rows_(marks.errors.size()) {}

  void leaveOut(Index row) {
    const auto columns = marks_.columns.middleRows<2>(row);
    gram_ -= columns.transpose() * columns;
    read_ -= columns.transpose() * marks_.errors.segment<2>(row);
    errors2_ -= marks_.errors.segment<2>(row).squaredNorm();
    rows_ -= 2;
  }

  /// Logarithm of the factors' density, given the marks, but for a constant.
  [[nodiscard]] double evidence(const Factors& logs) const {
    const Solved solved(*this, logs);
    const VectorXd read = solved.factor.matrixL().solve(solved.scale.cwiseProduct(read_));
    const double noise2 = std::exp(2.0 * logs[2]);
    const double determinant = 2.0 * solved.factor.matrixLLT().diagonal().array().log().sum() +
                               2.0 * static_cast<double>(rows_) * logs[2];
    const double before = logs.cwiseQuotient(kFactorSpread).squaredNorm();
    return -0.5 * (determinant + (errors2_ - read.squaredNorm()) / noise2 + before);
  }

  /// The factors of the largest density, to 1 %: steps along each until none is better, then smaller ones.
  void settle() {
    constexpr double kFirst = 1.0, kLast = 0.01;
    double best = evidence(logs_);
    for (double step = kFirst; step > kLast;) {
      Factors better = logs_;
      for (int way = 0; way < 6; ++way) {
        Factors there = logs_;
        there[way / 2] += way % 2 == 0 ? step : -step;
        if (there[2] < kLeastMarkFactor) continue;
        const double now = evidence(there);
        if (!(now > best)) continue;
        best = now;
        better = there;
      }
      if (better == logs_) step *= 0.5;
      logs_ = better;
    }
  }

  [[nodiscard]] double toleranceFactor() const { return std::exp(logs_[0]); }
  [[nodiscard]] double surfaceFactor() const { return std::exp(logs_[1]); }
  [[nodiscard]] double markFactor() const { return std::exp(logs_[2]); }

  /// Squared distance of each mark from what the others that take part, and the fit, predict there: of one
  /// that takes part by leaving it out, of one that does not as it is.
  [[nodiscard]] VectorXd distances2(const std::set<Index>& left_out) const {
    const Solved solved(*this, logs_);
    const double noise2 = std::pow(markFactor(), 2);
    const VectorXd best = solved.scale.cwiseProduct(solved.factor.solve(solved.scale.cwiseProduct(read_)));
    const MatrixXd known =
        solved.factor.matrixL().solve(solved.scale.asDiagonal() * marks_.columns.transpose());
    VectorXd distances(marks_.errors.size() / 2);
    for (Index row = 0; row < marks_.errors.size(); row += 2) {
      const Vector2d miss = marks_.errors.segment<2>(row) - marks_.columns.middleRows<2>(row) * best;
      const Eigen::Matrix2d own = known.middleCols<2>(row).transpose() * known.middleCols<2>(row);
      const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
      const Eigen::Matrix2d spread = unit + (left_out.contains(row) ? 1.0 : -1.0) * own;
      distances[row / 2] = miss.dot(spread.llt().solve(miss)) / noise2;
    }
    return distances;
  }

  /// Modes of the fit as the marks leave them, factors included: `draws` of them, a column each.
  [[nodiscard]] MatrixXd drawn(int draws) const {
    const Solved solved(*this, logs_);
    const VectorXd mean = solved.factor.solve(solved.scale.cwiseProduct(read_)) / markFactor();
    MatrixXd normal(mean.size(), draws);
    for (int draw = 0; draw < draws; ++draw) {
      const CounterRandom random(kDrawSeed, static_cast<std::uint64_t>(draw));
      for (Index k = 0; k < mean.size(); ++k) normal(k, draw) = random.normal(static_cast<std::uint64_t>(k));
    }
    const MatrixXd all = solved.factor.matrixU().solve(normal).colwise() + mean;
    return (marks_.scales(logs_).asDiagonal() * all).topRows(marks_.of_fit);
  }

 private:
  /// The normal matrix of all modes for given factors: 1 + D G D, D over the marks' noise.
  struct Solved {
    Solved(const Posterior& of, const Factors& logs) : scale(std::exp(-logs[2]) * of.marks_.scales(logs)) {
      MatrixXd normal = scale.asDiagonal() * of.gram_ * scale.asDiagonal();
      normal.diagonal().array() += 1.0;
      factor.compute(normal);
    }
    VectorXd scale;
    Eigen::LLT<MatrixXd> factor;
  };

  const WhitenedMarks& marks_;
  MatrixXd gram_;
  VectorXd read_;
  double errors2_;
  Index rows_;
  Factors logs_{Factors::Zero()};
};

/// The marks as they are to take part. Those that disagree are left out, the worst first, until none is
/// beyond what a good one may reach; where that would be many, none is: then it is no false mark, the head
/// has errors that its fit does not follow from place to place.
struct TakenPart {
  Posterior posterior;
  std::set<Index> left_out;
};

TakenPart withoutDisagreeing(const WhitenedMarks& marks) {
  Posterior all(marks);
  all.settle();
  const Index count = marks.errors.size() / 2;
  const double most = chiSquare2Above(kGoodMarkLeftOut / static_cast<double>(std::max<Index>(count, 1)));
  const auto share = static_cast<std::size_t>(kMostDisagreeing * static_cast<double>(count));
  TakenPart now{all, {}};
  while (count > 0) {
    VectorXd distances2 = now.posterior.distances2(now.left_out);
    for (const Index row : now.left_out) distances2[row / 2] = 0.0;
    Index worst = 0;
    if (distances2.maxCoeff(&worst) <= most) break;
    if (now.left_out.size() >= std::max(share, kFewDisagreeing)) return {all, {}};
    now.left_out.insert(2 * worst);
    now.posterior.leaveOut(2 * worst);
    now.posterior.settle();
  }
  return now;
}

/// A place of the field and the beam's error there: what the table leaves by the fit, and what moves it.
struct FieldPlace {
  Vector2d p_W_mm, left_mm;
  Modes modes_mm;
};

std::vector<FieldPlace> placesOf(const HeadFit& fit, const AimGrid& table,
                                 const Eigen::AlignedBox2d& field_W_mm) {
  std::vector<FieldPlace> places;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vector2d share(static_cast<double>(i % kSide) / (kSide - 1),
                         static_cast<double>(i / kSide) / (kSide - 1));
    const Vector2d p = field_W_mm.min() + share.cwiseProduct(field_W_mm.sizes());
    const auto d_mm = table.at_mm(p);
    const auto spot = d_mm ? fit.spotOf(p + *d_mm) : std::nullopt;
    if (!spot)
      throw HeadCalibrationError(
          fmt::format("the table does not take the beam to ({:.3f}, {:.3f}) mm", p.x(), p.y()));
    places.push_back({p, spot->p_W_mm - p, modesOf(fit, p + *d_mm)});
  }
  return places;
}

/// Largest errors of the drawn heads over the places. `local_mm2`: covariance of what each place has for
/// itself.
LargestError largestOf(const std::vector<FieldPlace>& places, const MatrixXd& heads,
                       const Eigen::Matrix2d& local_mm2) {
  const Index draws = heads.cols();
  const bool local = local_mm2.trace() > 0.0;
  const Eigen::Matrix2d root = local ? Eigen::Matrix2d(local_mm2.llt().matrixL()) : Eigen::Matrix2d::Zero();
  VectorXd largest = VectorXd::Zero(draws);
  std::vector<std::size_t> where(static_cast<std::size_t>(draws)), times(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    Eigen::Matrix2Xd off = (places[k].modes_mm.columns * heads).colwise() + places[k].left_mm;
    const CounterRandom random(kDrawSeed, kDraws + k);
    for (Index draw = 0; draw < draws; ++draw) {
      const auto at = 2 * static_cast<std::uint64_t>(draw);
      if (local) off.col(draw) += root * Vector2d(random.normal(at), random.normal(at + 1));
      if (off.col(draw).norm() <= largest[draw]) continue;
      largest[draw] = off.col(draw).norm();
      where[static_cast<std::size_t>(draw)] = k;
    }
  }
  for (const std::size_t k : where) ++times[k];
  const double mean = largest.mean();
  const double sigma = std::sqrt((largest.array() - mean).square().sum() / static_cast<double>(draws - 1));
  const auto most = std::distance(times.begin(), std::ranges::max_element(times));
  return {mean, 2.0 * sigma, places[static_cast<std::size_t>(most)].p_W_mm};
}

/// A mark that disagrees with all others stands for itself.
LargestError ownError(const HeadObservation& mark, const HeadFit& fit) {
  // Where the beam was wanted, to the table's interpolation: where the fit says that it lands.
  const Vector2d wanted = fit.spotOf(mark.aim_W_mm).value().p_W_mm;
  const double sigma = std::sqrt(0.5 * mark.wholeCovariance_mm2().trace());
  return {(mark.measured_W_mm - wanted).norm(), 2.0 * sigma, wanted};
}

}  // namespace

CoverBand coverBand(std::size_t count) {
  constexpr double kEachSide = 0.005;
  const auto n = static_cast<double>(count);
  const auto chance = [&](std::size_t hits) {
    const auto k = static_cast<double>(hits);
    return std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                    k * std::log1p(-kBeyondEllipse) + (n - k) * std::log(kBeyondEllipse));
  };
  CoverBand band{0, count};
  for (double below = chance(0); below <= kEachSide; below += chance(band.least)) ++band.least;
  for (double above = chance(count); above <= kEachSide; above += chance(band.most)) --band.most;
  return band;
}

bool VerifiedTable::coverHolds() const {
  const CoverBand band = coverBand(marks);
  return covered >= band.least && covered <= band.most;
}

VerifiedTable verifiedTable(const HeadFit& fit, const AimGrid& table, const Eigen::AlignedBox2d& field_W_mm,
                            std::span<const HeadObservation> marks) {
  const std::vector<FieldPlace> places = placesOf(fit, table, field_W_mm);
  const WhitenedMarks all = marksInTheirNoise(fit, marks, places.front().modes_mm);
  const auto [posterior, left_out] = withoutDisagreeing(all);
  VerifiedTable verified{.marks = marks.size(),
                         .covered = 0,
                         .disagreeing = left_out.size(),
                         .tolerance_factor = posterior.toleranceFactor(),
                         .surface_factor = posterior.surfaceFactor(),
                         .mark_factor = posterior.markFactor(),
                         .largest = {}};
  const double most = chiSquare2Above(kBeyondEllipse);
  for (const double distance2 : posterior.distances2(left_out))
    verified.covered += distance2 <= most ? 1U : 0U;
  const double freedom = std::max(2.0, 2.0 * static_cast<double>(marks.size()));
  const double by_chance2 = chiSquareAbove(freedom, kChanceAsNormal) / freedom;
  const double mark_factor2 = verified.mark_factor * verified.mark_factor;
  const double local = mark_factor2 > by_chance2 ? mark_factor2 - 1.0 : 0.0;
  verified.largest = largestOf(places, posterior.drawn(kDraws), local * all.mean_covariance_mm2);
  for (const Index row : left_out) {
    const LargestError own = ownError(marks[static_cast<std::size_t>(row / 2)], fit);
    if (own.value_mm > verified.largest.value_mm) verified.largest = own;
  }
  return verified;
}

}  // namespace kerfbench::calibrate
