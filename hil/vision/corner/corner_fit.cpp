// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>

#include "hil/vision/corner/corner_problem.h"

namespace kerfbench::vision {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostEvaluations = 40;
constexpr double kTolerance = 1e-5;
constexpr Index kLeastPixels = 200;
constexpr double kLeastNoise_gray = 0.3;
/// Largest sums of squares of ends that stop short, over that of an arc: beyond the first it is an arc;
/// between them either may be meant.
constexpr double kClearlyShort = 0.8;
constexpr double kSurelyShort = 0.5;

/// Sum of the squared residuals at x.
double squaresOf(const CornerProblem& problem, const VectorXd& x) {
  VectorXd f(problem.values());
  problem(x, f);
  return f.squaredNorm();
}

/// Start of a fit: the best of some shapes.
VectorXd startOf(const CornerProblem& problem, const CornerKnown& known, Meeting meeting) {
  constexpr std::array<std::array<double, 2>, 8> kEnds{{{0.01, 0.01},
                                                        {0.07, 0.07},
                                                        {0.07, 0.0},
                                                        {0.0, 0.07},
                                                        {-0.08, -0.08},
                                                        {0.2, 0.2},
                                                        {0.2, 0.0},
                                                        {0.0, 0.2}}};
  constexpr std::array<double, 6> kArcs{0.005, 0.04, 0.09, 0.17, 0.3, 0.45};
  VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  const auto tryOut = [&](const CornerShape& shape) {
    const VectorXd x = parametersOf(shape, known.light, meeting);
    const double squares = squaresOf(problem, x);
    if (squares < least) {
      least = squares;
      best = x;
    }
  };
  for (CornerShape shape : known.legs) {
    if (meeting == Meeting::kArc) {
      for (const double rounding_mm : kArcs) {
        shape.rounding_mm = rounding_mm;
        tryOut(shape);
      }
    } else {
      for (const auto& [in_mm, out_mm] : kEnds) {
        shape.in.over_mm = in_mm;
        shape.out.over_mm = out_mm;
        tryOut(shape);
      }
    }
  }
  return best;
}

struct Solved {
  VectorXd x;
  double squares{};
};

std::optional<Solved> solve(CornerProblem& problem, VectorXd x) {
  Eigen::LevenbergMarquardt<CornerProblem> lm(problem);
  lm.parameters.maxfev = kMostEvaluations;
  lm.parameters.ftol = lm.parameters.xtol = kTolerance;
  lm.minimize(x);
  if (!x.allFinite()) return std::nullopt;
  const double squares = squaresOf(problem, x);
  return Solved{std::move(x), squares};
}

std::optional<Solved> better(const std::optional<Solved>& arc, const std::optional<Solved>& ends) {
  if (!arc || !(arc->x[kMeet] > 0.0)) return ends;
  if (!ends) return arc;
  // Ends a little short of each other look like an arc.
  const bool is_short = ends->x[kMeet] < 0.0;
  return ends->squares < (is_short ? kClearlyShort : 1.0) * arc->squares ? ends : arc;
}

std::optional<MatrixXd> covarianceAt(CornerProblem& problem, const Solved& solved) {
  MatrixXd jacobian(problem.values(), problem.inputs());
  problem.df(solved.x, jacobian);
  const Eigen::LDLT<MatrixXd> normal((jacobian.transpose() * jacobian).eval());
  if (normal.info() != Eigen::Success || !normal.isPositive()) return std::nullopt;
  const double scatter = solved.squares / static_cast<double>(problem.pixels() - problem.inputs());
  return std::max(1.0, scatter) * normal.solve(MatrixXd::Identity(problem.inputs(), problem.inputs()));
}

}  // namespace

CornerShape CornerFit::shapeAt(const VectorXd& change) const {
  CornerShape s = shape;
  s.in.offset_mm += change[0];
  s.in.slope += change[1];
  s.in.curvature_per_mm += change[2];
  s.in.twist_per_mm2 += change[3];
  s.out.offset_mm += change[4];
  s.out.slope += change[5];
  s.out.curvature_per_mm += change[6];
  s.out.twist_per_mm2 += change[7];
  if (change.size() == kLegParameters + 1) {
    s.rounding_mm += change[kLegParameters];
  } else {
    setEnds(s.in.over_mm + s.out.over_mm + change[kLegParameters],
            s.in.over_mm - s.out.over_mm + change[kLegParameters + 1], s);
  }
  return s;
}

std::optional<CornerFit> fitCorner(const CornerPicture& picture, const CornerKnown& known) {
  CornerProblem problem(picture, known);
  if (problem.pixels() < kLeastPixels) return std::nullopt;
  // With noise as it is on the board, then as it is found to be.
  problem.setNoise(std::max(kLeastNoise_gray, picture.noise_gray));
  std::optional<Solved> arc, ends;
  const auto solveBoth = [&](bool again) {
    const auto one = [&](Meeting meeting, std::optional<Solved>& solved) {
      problem.setMeeting(meeting);
      if (again && !solved) return;
      solved = solve(problem, again ? solved->x : startOf(problem, known, meeting));
    };
    one(Meeting::kArc, arc);
    one(Meeting::kEnds, ends);
  };
  solveBoth(false);
  std::optional<Solved> best = better(arc, ends);
  if (!best) return std::nullopt;
  problem.setNoiseFrom(best->x);
  solveBoth(true);
  best = better(arc, ends);
  if (!best) return std::nullopt;
  problem.setMeeting(best->x.size() == kMeet + 1 ? Meeting::kArc : Meeting::kEnds);
  const std::optional<MatrixXd> covariance = covarianceAt(problem, *best);
  if (!covariance) return std::nullopt;
  const Index meets = best->x.size() - kMeet;
  CornerFit fit;
  fit.shape = shapeOf(best->x, known.legs.front());
  fit.light = lightOf(best->x);
  fit.covariance.resize(kLegParameters + meets, kLegParameters + meets);
  const MatrixXd& all = *covariance;
  fit.covariance << all.topLeftCorner(kLegParameters, kLegParameters),
      all.block(0, kMeet, kLegParameters, meets), all.block(kMeet, 0, meets, kLegParameters),
      all.bottomRightCorner(meets, meets);
  if (meets == 2 && best->x[kMeet] < 0.0 && arc && arc->x[kMeet] > 0.0 &&
      best->squares > kSurelyShort * arc->squares)
    fit.other = shapeOf(arc->x, known.legs.front());
  fit.scatter = std::sqrt(best->squares / static_cast<double>(problem.pixels()));
  return fit;
}

}  // namespace kerfbench::vision
