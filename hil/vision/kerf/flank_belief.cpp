// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/flank_belief.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "hil/base/parallel.h"

namespace kerfbench::vision {
namespace {

using Eigen::VectorXd;

constexpr int kFlankSize = 4;  // Law, begin, radius, blur.
using Vector = Eigen::Matrix<double, kFlankSize, 1>;
using Matrix = Eigen::Matrix<double, kFlankSize, kFlankSize>;

constexpr double kMostLaw = 2.0;
constexpr double kMostBegin = 0.85;
constexpr double kBlurShape_px = 0.03;  // No lens blurs quite by a Gaussian.
constexpr double kLeastBlur_px = 0.3;
/// What grid, grain, roughness and the shape of the lens's blur leave of a mean half width.
constexpr double kHalfWidthModel_mm = 8e-4;
/// What is left where depth is read from light: of a crease, which scorch dims, and of a cut that its walls
/// dim.
constexpr double kCreaseModel_mm = 1e-3;
constexpr double kDimCutModel_mm = 2e-3;
constexpr Eigen::Index kFlankLevels = 3;
constexpr int kFlankRounds = 8;
constexpr int kFlankHalvings = 5;
constexpr double kLeastMove = 1e-3;
constexpr int kFlanksPerThread = 8;  ///< Fewer are computed before a thread has started.
constexpr double kFlankStep = 0.05;  ///< Step of differences, in standard deviations.

/// Views by departures from what is known before, in its standard deviations.
class FlankProblem {
 public:
  FlankProblem(const std::vector<SeenFlank>& flanks, const FlankKnown& known, int threads)
      : flanks_(flanks),
        known_(known),
        threads_(std::min(threads, static_cast<int>(flanks.size()) / kFlanksPerThread)),
        blur_sigma_px_(std::hypot(known.blur.sigma_px, kBlurShape_px)) {
    const auto open = std::ranges::count_if(flanks, [](const SeenFlank& f) { return isOpen(f.query); });
    const auto all = static_cast<std::ptrdiff_t>(flanks.size());
    open_sigma_mm_ = kHalfWidthModel_mm * std::sqrt(static_cast<double>(open));
    shallow_share_ = std::sqrt(static_cast<double>(all - open));
    // An open flank is as wide as seen: two levels of it tell something.
    levels_ = (open > 0 ? kFlankLevels - 1.0 : 0.0) + (all > open ? kFlankLevels : 0.0);
  }

  [[nodiscard]] FlankView viewAt(const Vector& x) const {
    return {.growth = {std::clamp(known_.growth.law + known_.law_sigma * x[0], -kMostLaw, kMostLaw),
                       std::clamp(known_.growth.begin + known_.begin_sigma * x[1], 0.0, kMostBegin)},
            .beam_radius_mm = known_.beam_radius_mm * std::exp(known_.radius_share_sigma * x[2]),
            .lens_px = std::max(kLeastBlur_px, known_.blur.px + blur_sigma_px_ * x[3])};
  }
  /// Variance of the misses that is expected.
  [[nodiscard]] double levels() const { return levels_; }
  /// What the view misses of each flank, as if all open flanks together were one, and all shallow ones.
  [[nodiscard]] VectorXd missesAt(const Vector& x) const {
    const FlankView view = viewAt(x);
    const auto n = static_cast<Eigen::Index>(flanks_.size());
    VectorXd misses(kFlankLevels * n);
    base::forEachIndex(flanks_.size(), threads_, [&](std::size_t index) {
      const SeenFlank& flank = flanks_[index];
      const auto i = static_cast<Eigen::Index>(index);
      FlankQuery query = flank.query;
      query.growth = view.growth;
      query.beam_radius_mm = view.beam_radius_mm;
      query.lens_px = view.lens_px;
      const FlankFall fall = fallOf(query);
      const double shallow_mm = flank.is_crease ? kCreaseModel_mm : kDimCutModel_mm;
      const double sigma_mm = isOpen(query) ? open_sigma_mm_ : shallow_share_ * shallow_mm;
      misses.segment<kFlankLevels>(kFlankLevels * i) << fall.low_mm - flank.low_half_mm,
          fall.high_mm - flank.high_half_mm, fall.half_mm - flank.query.half_width_mm;
      misses.segment<kFlankLevels>(kFlankLevels * i) /= sigma_mm;
    });
    return misses;
  }

 private:
  const std::vector<SeenFlank>& flanks_;
  const FlankKnown& known_;
  int threads_;
  double blur_sigma_px_;
  double open_sigma_mm_{};
  double shallow_share_{};  ///< Root of how many are shallow.
  double levels_{};
};

double costOf(const Vector& x, const VectorXd& misses) { return x.squaredNorm() + misses.squaredNorm(); }

/// Goes the step, or half of it, or half of that, whichever leads downhill; returns how far.
double descend(const FlankProblem& problem, const Vector& step, Vector& x, VectorXd& misses) {
  double share = 1.0;
  for (int halving = 0; halving < kFlankHalvings; ++halving, share *= 0.5) {
    const Vector next = x + share * step;
    const VectorXd there = problem.missesAt(next);
    if (!(costOf(next, there) <= costOf(x, misses))) continue;  // Nor where it is no number.
    x = next;
    misses = there;
    return (share * step).norm();
  }
  return 0.0;
}

}  // namespace

FlankBelief beliefOf(const std::vector<SeenFlank>& flanks, const FlankKnown& known, int threads) {
  const FlankProblem problem(flanks, known, threads);
  Vector x = Vector::Zero();
  Matrix normal = Matrix::Identity();
  VectorXd misses = problem.missesAt(x);
  for (int round = 0; round < kFlankRounds && !flanks.empty(); ++round) {
    Eigen::MatrixXd slope(misses.size(), kFlankSize);
    for (Eigen::Index k = 0; k < kFlankSize; ++k)
      slope.col(k) = (problem.missesAt(x + kFlankStep * Vector::Unit(k)) - misses) / kFlankStep;
    normal = Matrix::Identity() + slope.transpose() * slope;
    const Vector full = -normal.ldlt().solve(Vector(x + slope.transpose() * misses));
    if (!(descend(problem, full, x, misses) > kLeastMove)) break;
  }
  // A scatter beyond what is expected is that of the model: it holds for the views as well.
  const double excess = flanks.empty() ? 1.0 : std::max(1.0, misses.squaredNorm() / problem.levels());
  const Matrix covariance = excess * Matrix(normal.inverse());
  const Matrix root = Eigen::LLT<Matrix>(covariance).matrixL();
  FlankBelief belief{problem.viewAt(x), {}};
  for (Eigen::Index k = 0; k < kFlankSize; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const Vector away = side * std::sqrt(static_cast<double>(kFlankSize)) * root.col(k);
      belief.views.push_back(problem.viewAt(x + away));
      belief.views.back().weight = 0.5 / kFlankSize;
    }
  }
  // Flanks do not tell how bright the back light is.
  for (const double side : {-1.0, 1.0}) {
    if (!(known.open_sigma > 0.0)) break;
    belief.views.push_back(belief.likely);
    belief.views.back().open += side * known.open_sigma;
    belief.views.back().weight = 0.5;
  }
  return belief;
}

}  // namespace kerfbench::vision
