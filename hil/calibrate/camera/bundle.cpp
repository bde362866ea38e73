// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/bundle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "hil/vision/image/lens_distortion.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kLens = 9;
constexpr Index kPose = 6;
constexpr int kBundleRounds = 100;
constexpr double kAtRest = 1e-9;
constexpr int kWeightings = 3;

Eigen::Matrix3d crossMatrix(const Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

struct State {
  BundleLens lens;
  std::vector<Eigen::Isometry3d> X_CB;

  void add(const VectorXd& step) {
    lens.pinhole += step.head<4>();
    for (Index i = 0; i < 5; ++i) lens.distortion.at(static_cast<std::size_t>(i)) += step[4 + i];
    for (std::size_t v = 0; v < X_CB.size(); ++v) {
      const auto pose = step.segment<kPose>(kLens + kPose * static_cast<Index>(v));
      const Vector3d turn = pose.head<3>();
      const double angle_rad = turn.norm();
      if (angle_rad > 0.0) {
        const Eigen::Quaterniond q(Eigen::AngleAxisd(angle_rad, turn / angle_rad).toRotationMatrix() *
                                   X_CB[v].linear());
        X_CB[v].linear() = q.normalized().toRotationMatrix();
      }
      X_CB[v].translation() += pose.tail<3>();
    }
  }
};

/// One of the start's values that count as measured: what is missed by, in standard deviations, and how that
/// changes with the parameter at `at`.
struct Known {
  Index at{};
  double miss{}, slope{};
};

/// See adjust(); none for a pinhole.
std::vector<Known> knownOf(const State& state, const Bundle& start) {
  if (!(start.lens.telecentric_mm > 0.0)) return {};
  constexpr double kDistance_mm = 1.0;
  constexpr double kAxisShare = 0.01;
  constexpr double kSquare_rad = 0.01745;
  std::vector<Known> known;
  for (const Index i : {2, 3}) {
    const double sigma = kAxisShare * start.lens.pinhole[0];
    known.push_back({i, (start.lens.pinhole[i] - state.lens.pinhole[i]) / sigma, 1.0 / sigma});
  }
  for (std::size_t v = 0; v < start.X_CB.size(); ++v) {
    const double moved_mm = state.X_CB[v].translation().z() - start.X_CB[v].translation().z();
    known.push_back(
        {kLens + kPose * static_cast<Index>(v) + 5, -moved_mm / kDistance_mm, 1.0 / kDistance_mm});
  }
  // A small turn by dx about x moves the target's normal n by -dx n_z along y.
  const Vector3d n = state.X_CB.front().linear().col(2);
  known.push_back({kLens, -n.y() / kSquare_rad, -n.z() / kSquare_rad});
  known.push_back({kLens + 1, -n.x() / kSquare_rad, n.z() / kSquare_rad});
  return known;
}

/// Weighted sum of squares; infinite for a point behind the camera.
double costOf(const State& state, const Bundle& bundle, const std::vector<double>& weight) {
  double sum = 0.0;
  for (const Known& known : knownOf(state, bundle)) sum += known.miss * known.miss;
  for (std::size_t v = 0; v < bundle.points.size(); ++v) {
    double of_view = 0.0;
    for (const BundlePoint& point : bundle.points[v]) {
      if (!((state.X_CB[v] * Vector3d(point.p_B_mm.x(), point.p_B_mm.y(), 0.0)).z() > 0.0)) return HUGE_VAL;
      const Vector2d miss = point.pixel - project(state.lens, state.X_CB[v], point.p_B_mm);
      of_view += miss.dot(point.covariance_px2.inverse() * miss);
    }
    sum += weight[v] * of_view;
  }
  return std::isfinite(sum) ? sum : HUGE_VAL;
}

struct Normal {
  MatrixXd matrix;
  VectorXd right;
};

Normal normalOf(const State& state, const Bundle& bundle, const std::vector<double>& weight) {
  const Index size = kLens + kPose * static_cast<Index>(bundle.points.size());
  Normal normal{MatrixXd::Zero(size, size), VectorXd::Zero(size)};
  for (std::size_t v = 0; v < bundle.points.size(); ++v) {
    Eigen::Matrix<double, kLens + kPose, kLens + kPose> square;
    Eigen::Matrix<double, kLens + kPose, 1> right;
    square.setZero();
    right.setZero();
    ProjectionSlopes by;
    for (const BundlePoint& point : bundle.points[v]) {
      const Vector2d miss = point.pixel - project(state.lens, state.X_CB[v], point.p_B_mm, by);
      const ProjectionSlopes weighted = point.covariance_px2.inverse() * by;
      square.noalias() += weighted.transpose() * by;
      right.noalias() += weighted.transpose() * miss;
    }
    const Index at = kLens + kPose * static_cast<Index>(v);
    normal.matrix.topLeftCorner<kLens, kLens>() += weight[v] * square.topLeftCorner<kLens, kLens>();
    normal.matrix.block<kLens, kPose>(0, at) = weight[v] * square.topRightCorner<kLens, kPose>();
    normal.matrix.block<kPose, kLens>(at, 0) = weight[v] * square.bottomLeftCorner<kPose, kLens>();
    normal.matrix.block<kPose, kPose>(at, at) = weight[v] * square.bottomRightCorner<kPose, kPose>();
    normal.right.head<kLens>() += weight[v] * right.head<kLens>();
    normal.right.segment<kPose>(at) = weight[v] * right.tail<kPose>();
  }
  for (const Known& known : knownOf(state, bundle)) {
    normal.matrix(known.at, known.at) += known.slope * known.slope;
    normal.right[known.at] += known.slope * known.miss;
  }
  return normal;
}

/// Focal lengths and powers of the radius differ by orders of magnitude: solved with unit diagonal.
class Scaled {
 public:
  Scaled(const MatrixXd& matrix, double damping)
      : scale_(matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()) {
    MatrixXd even = scale_.asDiagonal() * matrix * scale_.asDiagonal();
    even.diagonal().array() += damping;
    llt_.compute(even);
  }
  [[nodiscard]] bool sound() const { return llt_.info() == Eigen::Success; }
  [[nodiscard]] VectorXd solve(const VectorXd& right) const {
    return scale_.asDiagonal() * llt_.solve(scale_.asDiagonal() * right);
  }
  [[nodiscard]] MatrixXd inverse() const {
    const MatrixXd unit = MatrixXd::Identity(scale_.size(), scale_.size());
    return scale_.asDiagonal() * llt_.solve(unit) * scale_.asDiagonal();
  }

 private:
  VectorXd scale_;
  Eigen::LLT<MatrixXd> llt_;
};

bool settle(State& state, const Bundle& bundle, const std::vector<double>& weight) {
  double damping = 1e-4;
  double cost = costOf(state, bundle, weight);
  int idle = 0;
  double decrease = 1.0;  // Relative decrease of the cost by the last step.
  for (int round = 0; round < kBundleRounds; ++round) {
    const Normal normal = normalOf(state, bundle, weight);
    bool better = false;
    for (int attempt = 0; attempt < 12 && !better; ++attempt, damping *= 10.0) {
      const Scaled system(normal.matrix, damping);
      if (!system.sound()) continue;
      State next = state;
      next.add(system.solve(normal.right));
      const double next_cost = costOf(next, bundle, weight);
      if (next_cost > cost) continue;
      better = true;
      // Twice within rounding: the last steps, nearly undamped, have squeezed out what there is.
      decrease = cost > 0.0 ? (cost - next_cost) / cost : 0.0;
      idle = decrease <= 1e-13 ? idle + 1 : 0;
      state = next;
      cost = next_cost;
      damping = std::max(1e-15, damping * 1e-3);
      if (idle >= 2) return true;
    }
    if (!better) return std::isfinite(cost);
  }
  // A telecentric lens without distortion has no axis: the fit wanders along it, and the cost is at rest.
  return bundle.lens.telecentric_mm > 0.0 && decrease <= kAtRest;
}

std::vector<std::vector<Vector2d>> residualsOf(const State& state, const Bundle& bundle) {
  std::vector<std::vector<Vector2d>> residuals(bundle.points.size());
  for (std::size_t v = 0; v < bundle.points.size(); ++v) {
    for (const BundlePoint& point : bundle.points[v])
      residuals[v].push_back(point.pixel - project(state.lens, state.X_CB[v], point.p_B_mm));
  }
  return residuals;
}

double weightedSquares(const std::vector<Vector2d>& residuals, const std::vector<BundlePoint>& points) {
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i)
    sum += residuals[i].dot(points[i].covariance_px2.inverse() * residuals[i]);
  return sum;
}

double squaresOf(const std::vector<Vector2d>& residuals) {
  double sum = 0.0;
  for (const Vector2d& r : residuals) sum += r.squaredNorm();
  return sum;
}

double meanVariance(const std::vector<BundlePoint>& points) {
  double sum = 0.0;
  for (const BundlePoint& point : points) sum += 0.5 * point.covariance_px2.trace();
  return sum / static_cast<double>(points.size());
}

}  // namespace

Vector2d project(const BundleLens& lens, const Eigen::Isometry3d& X_CB, const Vector2d& p_B_mm) {
  const Vector3d c = X_CB * Vector3d(p_B_mm.x(), p_B_mm.y(), 0.0);
  const double depth_mm = lens.telecentric_mm > 0.0 ? lens.telecentric_mm : c.z();
  const Vector2d d = vision::distort(lens.distortion, c.head<2>() / depth_mm).point;
  return {lens.pinhole[2] + lens.pinhole[0] * d.x(), lens.pinhole[3] + lens.pinhole[1] * d.y()};
}

Vector2d project(const BundleLens& lens, const Eigen::Isometry3d& X_CB, const Vector2d& p_B_mm,
                 ProjectionSlopes& by) {
  const Vector3d turned = X_CB.linear() * Vector3d(p_B_mm.x(), p_B_mm.y(), 0.0);
  const Vector3d c = turned + X_CB.translation();
  const bool pinhole = !(lens.telecentric_mm > 0.0);
  const double depth_mm = pinhole ? c.z() : lens.telecentric_mm;
  const Vector2d n = c.head<2>() / depth_mm;
  const vision::Distorted d = vision::distort(lens.distortion, n);
  const double fx = lens.pinhole[0];
  const double fy = lens.pinhole[1];
  const double r2 = n.squaredNorm();
  const double xy = 2.0 * n.x() * n.y();
  const double xx = r2 + 2.0 * n.x() * n.x();
  const double yy = r2 + 2.0 * n.y() * n.y();
  by.setZero();
  by(0, 0) = d.point.x();
  by(1, 1) = d.point.y();
  by(0, 2) = by(1, 3) = 1.0;
  by.row(0).segment<5>(4) << fx * n.x() * r2, fx * n.x() * r2 * r2, fx * xy, fx * xx,
      fx * n.x() * r2 * r2 * r2;
  by.row(1).segment<5>(4) << fy * n.y() * r2, fy * n.y() * r2 * r2, fy * yy, fy * xy,
      fy * n.y() * r2 * r2 * r2;
  Eigen::Matrix<double, 2, 3> by_c;
  by_c << 1.0, 0.0, -n.x(), 0.0, 1.0, -n.y();
  if (!pinhole) by_c.col(2).setZero();
  by_c = Vector2d(fx, fy).asDiagonal() * d.jacobian * by_c / depth_mm;
  by.block<2, 3>(0, 9) = -by_c * crossMatrix(turned);
  by.block<2, 3>(0, 12) = by_c;
  return {lens.pinhole[2] + fx * d.point.x(), lens.pinhole[3] + fy * d.point.y()};
}

BundleResult adjust(const Bundle& start) {
  const std::size_t views = start.points.size();
  if (views == 0 || start.X_CB.size() != views ||
      std::ranges::any_of(start.points, [](const auto& points) { return points.size() < 4; })) {
    throw std::invalid_argument("bundle adjustment: every view needs a pose and four points");
  }
  State state{start.lens, start.X_CB};
  // Corners' covariances need not be to scale: at first all views count alike.
  std::vector<double> weight;
  for (const auto& of_view : start.points) weight.push_back(meanVariance(of_view));
  BundleResult result;
  result.sigma_px.assign(views, 1.0);
  std::size_t points = 0;
  for (const auto& of_view : start.points) points += of_view.size();
  for (int weighting = 0; weighting < kWeightings; ++weighting) {
    result.settled = settle(state, start, weight);
    result.residuals_px = residualsOf(state, start);
    for (std::size_t v = 0; v < views; ++v) {
      // Degrees of freedom of a view: its residuals less its pose and its share of the lens, which are fitted
      // to them.
      const auto n = static_cast<double>(start.points[v].size());
      const double freedom = 2.0 * n - kPose - kLens * n / static_cast<double>(points);
      const double scatter =
          weightedSquares(result.residuals_px[v], start.points[v]) / std::max(1.0, freedom);
      weight[v] = 1.0 / std::max(1e-12, scatter);
      result.sigma_px[v] = std::sqrt(squaresOf(result.residuals_px[v]) / (2.0 * n));
    }
  }
  result.lens = state.lens;
  result.X_CB = state.X_CB;
  double sum = 0.0;
  for (const auto& of_view : result.residuals_px) sum += squaresOf(of_view);
  result.rms_px = std::sqrt(sum / (2.0 * static_cast<double>(points)));
  const Scaled system(normalOf(state, start, weight).matrix, 0.0);
  result.covariance = system.inverse();
  if (!system.sound()) result.covariance.setConstant(std::nan(""));
  return result;
}

}  // namespace kerfbench::calibrate
