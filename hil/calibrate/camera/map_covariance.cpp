// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/map_covariance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "hil/calibrate/camera/bundle.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Index;
using Matrix15 = Eigen::Matrix<double, 15, 15>;

constexpr int kGrid = 21;  // Points along each side of the area.
constexpr double kNegligible = 1e-3;

/// How the point of the plane seen at a fixed pixel moves with the parameters: by the implicit function, less
/// the pixel's slopes over its slopes by the point.
ProjectionSlopes mapSlopes(const vision::CameraCalibration& c, const Eigen::Vector2d& p_mm) {
  ProjectionSlopes by;
  const BundleLens lens{{c.fx_px, c.fy_px, c.cx_px, c.cy_px}, c.distortion, c.telecentric_mm};
  (void)project(lens, c.X_CP, p_mm, by);
  return -c.localMap(p_mm).pixel_per_mm.inverse() * by;
}

std::vector<Eigen::Vector2d> seenPoints(const vision::CameraCalibration& c) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const Eigen::Array2d share(static_cast<double>(i) / (kGrid - 1), static_cast<double>(j) / (kGrid - 1));
      const Eigen::Vector2d p_mm = c.area_mm.min().array() + share * c.area_mm.sizes().array();
      if (c.pixelIfSeen(p_mm, 0.0)) points.push_back(p_mm);
    }
  }
  return points;
}

/// L with L L^T = covariance, which may have lost a rank to rounding.
Matrix15 rootOf(const Matrix15& covariance) {
  const Eigen::Matrix<double, 15, 1> sigma = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Matrix15 even = sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix15> solver(0.5 * (even + even.transpose()));
  return sigma.asDiagonal() * solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

void setMapCovariance(const Matrix15& covariance, vision::CameraCalibration& calibration) {
  if (!covariance.allFinite()) throw std::invalid_argument("map covariance: not finite");
  const std::vector<Eigen::Vector2d> points = seenPoints(calibration);
  if (points.empty()) throw std::invalid_argument("map covariance: the area is empty");
  const Matrix15 root = rootOf(covariance);
  Eigen::MatrixXd effect(2 * static_cast<Index>(points.size()), 15);
  double most_mm2 = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ProjectionSlopes of_point = mapSlopes(calibration, points[i]) * root;
    effect.middleRows<2>(2 * static_cast<Index>(i)) = of_point;
    const Eigen::Matrix2d spread = of_point * of_point.transpose();
    most_mm2 = std::max(most_mm2, SymmetricEigen<2>(spread).values[1]);
  }
  calibration.map_u_mm = std::sqrt(most_mm2);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(effect, Eigen::ComputeThinV);
  calibration.error_modes.clear();
  double strongest_mm = 0.0;
  for (Index k = 0; k < 15; ++k) {
    const Eigen::VectorXd moved = effect * svd.matrixV().col(k);
    const double reach_mm = moved.cwiseAbs().maxCoeff();
    strongest_mm = std::max(strongest_mm, reach_mm);
    if (!(reach_mm > kNegligible * strongest_mm)) continue;
    Eigen::Matrix<double, 15, 1> mode = root * svd.matrixV().col(k);
    // Sign of the mode: free, so it is set in the same way on every computer.
    Index largest = 0;
    moved.cwiseAbs().maxCoeff(&largest);
    if (moved[largest] < 0.0) mode = -mode;
    calibration.error_modes.push_back(mode);
  }
}

}  // namespace kerfbench::calibrate
