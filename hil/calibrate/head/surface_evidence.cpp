// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/surface_evidence.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace kerfbench::hil {
namespace {

constexpr Eigen::Index kCount = static_cast<Eigen::Index>(kHeadParameterCount);
constexpr double kMoved = 1e-4;  // Of its prior variance: all of them together change the evidence by 0.02.
const double kLeastEvidence = std::log(20.0);
constexpr double kLeastScore =
    3.0;  // Its square over four is about the evidence: below, no surface is tried.

constexpr double kFirstAmplitude_mm = 0.001, kLeastAmplitude_mm = 1e-4, kMostAmplitude_mm = 10.0;

Eigen::MatrixXd squareOf(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
  square.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  return square;
}

/// What the marks tell of the surface when the model is left to fit itself: the model's part projected out.
class SurfaceInformation {
 public:
  explicit SurfaceInformation(const JointMarks& marks) : marks_(marks) {
    Eigen::MatrixXd normal = marks.square().topLeftCorner<kCount, kCount>();
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd step =
        factor.solve(marks.square().row(kCount).head<kCount>().transpose() + marks.home());
    gradient_ = marks.crossed().col(kCount) - marks.crossed().leftCols<kCount>() * step;
    crossed_ = factor.matrixL().solve(marks.crossed().leftCols<kCount>().transpose());
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
    Eigen::MatrixXd scaled = scale.asDiagonal() * information_(moved, moved) * scale.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
    const Eigen::VectorXd half = factor.matrixL().solve(scale.cwiseProduct(gradient_(moved)));
    const Eigen::VectorXd diagonal = factor.matrixLLT().diagonal();
    return 0.5 * half.squaredNorm() - diagonal.array().log().sum();
  }

 private:
  const JointMarks& marks_;
  Eigen::MatrixXd crossed_, information_;  ///< Of the latter the lower part.
  Eigen::VectorXd gradient_;
};

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
  const auto at = [&](double decay, double amplitude_mm) {
    SurfacePrior prior{amplitude_mm, decay, 0.0};
    prior.evidence = information.evidence(sigmasOf(prior, basis));
    return prior;
  };
  SurfacePrior best{kFirstAmplitude_mm, 0.0, -INFINITY};
  for (const double decay : decays) {
    // Up the slope by factors of two, from where the last decay had its best: there is one top.
    SurfacePrior here = at(decay, best.amplitude_mm);
    for (const double factor : {2.0, 0.5}) {
      for (SurfacePrior next = at(decay, factor * here.amplitude_mm);
           next.evidence > here.evidence && next.amplitude_mm > kLeastAmplitude_mm &&
           next.amplitude_mm < kMostAmplitude_mm;
           next = at(decay, factor * here.amplitude_mm))
        here = next;
    }
    if (here.evidence > best.evidence) best = here;
  }
  if (best.evidence < kLeastEvidence) return std::nullopt;
  return best;
}

}  // namespace kerfbench::hil
