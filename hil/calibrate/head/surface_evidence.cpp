// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/surface_evidence.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "hil/calibrate/head/head_parameters.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kMoved = 1e-4;  // Least gain of a coefficient in units of its prior variance; all others
                                 // together change the evidence by 0.02.
const double kLeastEvidence = std::log(20.0);
/// Least score of a surface that is tried; its square over four is about the evidence.
constexpr double kLeastScore = 3.0;

constexpr int kQuickDegree = 6;
constexpr double kFirstAmplitude_mm = 0.001, kLeastAmplitude_mm = 1e-4, kMostAmplitude_mm = 10.0;

Eigen::MatrixXd squareOf(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
  square.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  return square;
}

/// Information of the marks on the surface, with the model's part projected out.
class SurfaceInformation {
 public:
  explicit SurfaceInformation(const JointMarks& marks) : marks_(marks) {
    Eigen::MatrixXd normal = marks.square().topLeftCorner<kHeadColumns, kHeadColumns>();
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd step =
        factor.solve(marks.square().row(kHeadColumns).head<kHeadColumns>().transpose() + marks.home());
    gradient_ = marks.crossed().col(kHeadColumns) - marks.crossed().leftCols<kHeadColumns>() * step;
    crossed_ = factor.matrixL().solve(marks.crossed().leftCols<kHeadColumns>().transpose());
  }

  /// Derivative of the evidence by the square of the amplitude at zero, over its own scatter if there is no
  /// surface; correlations of the coefficients are neglected.
  [[nodiscard]] double score(const Eigen::VectorXd& sigmas) const {
    const Eigen::VectorXd expected = marks_.surfaceDiagonal() - crossed_.colwise().squaredNorm().transpose();
    const Eigen::VectorXd weights = sigmas.cwiseAbs2();
    const double excess = weights.dot(gradient_.cwiseAbs2() - expected);
    return excess / std::sqrt(2.0 * weights.cwiseProduct(expected).squaredNorm());
  }

  void complete() { information_ = marks_.surfaceSquare() - squareOf(crossed_); }

  [[nodiscard]] double evidence(const Eigen::VectorXd& sigmas) const {
    // Coefficients that the marks do not move, of high degree mostly, change nothing.
    std::vector<Eigen::Index> moved;
    for (Eigen::Index k = 0; k < sigmas.size(); ++k) {
      if (sigmas[k] * sigmas[k] * information_(k, k) > kMoved) moved.push_back(k);
    }
    const Eigen::VectorXd scale = sigmas(moved);
    Eigen::MatrixXd normal(scale.size(), scale.size());  // Normal matrix, lower part.
    for (Eigen::Index j = 0; j < scale.size(); ++j) {
      const auto below = Eigen::seq(j, Eigen::last);
      normal(below, j) = scale[j] * scale(below).cwiseProduct(
                                        information_(moved, moved[static_cast<std::size_t>(j)])(below));
    }
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(normal);
    const Eigen::VectorXd half = factor.matrixL().solve(scale.cwiseProduct(gradient_(moved)));
    return 0.5 * half.squaredNorm() - normal.diagonal().array().log().sum();
  }

 private:
  const JointMarks& marks_;
  Eigen::MatrixXd crossed_, information_;  ///< Sums over the marks; of the information the lower part alone.
  Eigen::VectorXd gradient_;
};

/// Up the slope by factors of two of the amplitude: there is one top. Only functions up to this degree.
SurfacePrior topOf(const SurfaceInformation& information, const SmoothBasis& basis, int degree,
                   const SurfacePrior& start) {
  const Eigen::Index beyond = basis.size() - (degree + 1) * (degree + 2) / 2;
  const auto at = [&](double amplitude_mm) {
    SurfacePrior prior{amplitude_mm, start.decay, 0.0};
    Eigen::VectorXd sigmas = sigmasOf(prior, basis);
    sigmas.head(basis.size()).tail(beyond).setZero();
    sigmas.tail(beyond).setZero();
    prior.evidence = information.evidence(sigmas);
    return prior;
  };
  const SurfacePrior first = at(start.amplitude_mm);
  for (const double factor : {2.0, 0.5}) {
    SurfacePrior top = first;
    for (SurfacePrior next = at(factor * top.amplitude_mm);
         next.evidence > top.evidence && next.amplitude_mm > kLeastAmplitude_mm &&
         next.amplitude_mm < kMostAmplitude_mm;
         next = at(factor * top.amplitude_mm))
      top = next;
    if (top.evidence > first.evidence) return top;
  }
  return first;
}

}  // namespace

std::vector<double> promisingDecays(const JointMarks& marks, const SmoothBasis& basis) {
  const SurfaceInformation information(marks);
  std::vector<double> promising;
  for (const double decay : {0.5, 0.7, 0.85, 1.0}) {
    if (information.score(sigmasOf({1.0, decay, 0.0}, basis)) > kLeastScore) promising.push_back(decay);
  }
  return promising;
}

std::optional<SurfacePrior> bestSurface(const JointMarks& marks, const SmoothBasis& basis,
                                        std::span<const double> decays) {
  SurfaceInformation information(marks);
  information.complete();
  SurfacePrior best{kFirstAmplitude_mm, 0.0, -INFINITY};
  for (const double decay : decays) {
    // From where the last decay had its best, by the lower degrees first: that is quick, and near the top.
    const SurfacePrior near =
        topOf(information, basis, std::min(basis.degree(), kQuickDegree), {best.amplitude_mm, decay, 0.0});
    const SurfacePrior here = topOf(information, basis, basis.degree(), near);
    if (here.evidence > best.evidence) best = here;
  }
  if (best.evidence < kLeastEvidence) return std::nullopt;
  return best;
}

}  // namespace kerfbench::calibrate
