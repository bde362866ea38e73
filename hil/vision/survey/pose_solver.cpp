// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/survey/pose_solver.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace kerfbench::vision {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d onFace(const Vector2d& p_F_mm) { return {p_F_mm.x(), p_F_mm.y(), 0.0}; }

/// Everything that the marks' pixels depend on.
struct Scene {
  std::vector<const CameraCalibration*> cameras;
  std::vector<Vector2d> marks_F_mm;
  const std::vector<SightedMark>* sighted;

  /// What the pixels differ from their projections, in units of sigma; nullopt where one is behind a camera.
  [[nodiscard]] std::optional<VectorXd> residuals(const Eigen::Isometry3d& X_WF) const {
    VectorXd r(2 * static_cast<Eigen::Index>(sighted->size()));
    for (std::size_t i = 0; i < sighted->size(); ++i) {
      const SightedMark& m = (*sighted)[i];
      const auto pixel = pixelOf(*cameras[m.view], X_WF * onFace(marks_F_mm[m.mark]));
      if (!pixel) return std::nullopt;
      r.segment<2>(2 * static_cast<Eigen::Index>(i)) = (m.pixel - *pixel) / m.sigma_px;
    }
    return r;
  }
};

constexpr double kTurn_rad = 1e-5;  // Steps of the difference quotients.
constexpr double kShift_mm = 1e-3;
constexpr int kMostRounds = 20;

/// How the residuals change with a motion of the face.
std::optional<MatrixXd> jacobian(const Scene& scene, const Eigen::Isometry3d& X_WF,
                                 const Vector3d& centre_W) {
  MatrixXd j(2 * static_cast<Eigen::Index>(scene.sighted->size()), 6);
  for (Eigen::Index k = 0; k < 6; ++k) {
    SmallMotion step = SmallMotion::Zero();
    step[k] = k < 3 ? kTurn_rad : kShift_mm;
    const auto more = scene.residuals(moved(step, centre_W, X_WF));
    const auto less = scene.residuals(moved(-step, centre_W, X_WF));
    if (!more || !less) return std::nullopt;
    j.col(k) = (*more - *less) / (2.0 * step[k]);
  }
  return j;
}

/// What the solution moves by where the residuals change by `change`.
SmallMotion solutionShift(const Eigen::LDLT<Eigen::Matrix<double, 6, 6>>& normal, const MatrixXd& j,
                          const VectorXd& change) {
  return normal.solve(-j.transpose() * change);
}

void addPrintModes(const ExpectedFace& face, const Scene& scene, const MatrixXd& j,
                   const Eigen::LDLT<Eigen::Matrix<double, 6, 6>>& normal, FacePose& pose) {
  const VectorXd at = scene.residuals(pose.X_WF).value();
  for (std::size_t mark = 0; mark < scene.marks_F_mm.size(); ++mark) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      Scene other = scene;
      other.marks_F_mm[mark][axis] += face.print_sigma_mm;
      if (const auto r = other.residuals(pose.X_WF)) pose.modes.push_back(solutionShift(normal, j, *r - at));
    }
  }
}

void addCameraModes(const Scene& scene, const MatrixXd& j,
                    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>>& normal, FacePose& pose) {
  const VectorXd at = scene.residuals(pose.X_WF).value();
  for (std::size_t view = 0; view < scene.cameras.size(); ++view) {
    for (std::size_t mode = 0; mode < scene.cameras[view]->error_modes.size(); ++mode) {
      const CameraCalibration changed = withMode(*scene.cameras[view], mode);
      Scene other = scene;
      other.cameras[view] = &changed;
      if (const auto r = other.residuals(pose.X_WF)) pose.modes.push_back(solutionShift(normal, j, *r - at));
    }
  }
}

}  // namespace

std::optional<Vector2d> pixelOf(const CameraCalibration& calibration, const Vector3d& p_W_mm) {
  CameraCalibration through = calibration;
  through.X_CP.translation() = calibration.X_CP * p_W_mm;
  if (!(through.X_CP.translation().z() > 0.0)) return std::nullopt;
  return through.pixelFromPlane(Vector2d::Zero());
}

Eigen::Isometry3d moved(const SmallMotion& motion, const Vector3d& centre_W_mm,
                        const Eigen::Isometry3d& X_WF) {
  const double angle_rad = motion.head<3>().norm();
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  if (angle_rad > 0.0)
    turn.linear() = Eigen::AngleAxisd(angle_rad, motion.head<3>() / angle_rad).toRotationMatrix();
  return Eigen::Translation3d(centre_W_mm + motion.tail<3>()) * turn * Eigen::Translation3d(-centre_W_mm) *
         X_WF;
}

CameraCalibration withMode(const CameraCalibration& calibration, std::size_t mode) {
  CameraCalibration other = calibration;
  const Eigen::Matrix<double, CameraCalibration::kParameters, 1>& e = calibration.error_modes.at(mode);
  other.fx_px += e[0];
  other.fy_px += e[1];
  other.cx_px += e[2];
  other.cy_px += e[3];
  for (Eigen::Index i = 0; i < 5; ++i) other.distortion.at(static_cast<std::size_t>(i)) += e[4 + i];
  const double angle_rad = e.segment<3>(9).norm();
  if (angle_rad > 0.0) {
    other.X_CP.linear() =
        Eigen::AngleAxisd(angle_rad, e.segment<3>(9) / angle_rad).toRotationMatrix() * other.X_CP.linear();
  }
  other.X_CP.translation() += e.tail<3>();
  return other;
}

std::optional<FacePose> solvePose(const ExpectedFace& face, const std::vector<SurveyView>& views,
                                  const std::vector<SightedMark>& sighted) {
  Scene scene{{}, {}, &sighted};
  for (const SurveyView& view : views) scene.cameras.push_back(view.calibration);
  Vector2d middle_F_mm = Vector2d::Zero();
  for (const RegistrationMark& mark : face.print->marks) {
    scene.marks_F_mm.push_back(mark.p_SM_mm);
    middle_F_mm += mark.p_SM_mm / static_cast<double>(face.print->marks.size());
  }
  FacePose pose;
  pose.X_WF = face.X_WF;
  pose.marks = static_cast<int>(sighted.size());
  for (int round = 0; round < kMostRounds; ++round) {
    pose.centre_W_mm = pose.X_WF * onFace(middle_F_mm);
    const auto r = scene.residuals(pose.X_WF);
    const auto j = r ? jacobian(scene, pose.X_WF, pose.centre_W_mm) : std::nullopt;
    if (!j) return std::nullopt;
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> normal(j->transpose() * *j);
    const SmallMotion step = solutionShift(normal, *j, *r);
    if (!step.allFinite()) return std::nullopt;
    pose.X_WF = moved(step, pose.centre_W_mm, pose.X_WF);
    if (step.head<3>().norm() > 1e-9 || step.tail<3>().norm() > 1e-7) continue;
    const VectorXd left = scene.residuals(pose.X_WF).value_or(*r);
    double square_px2 = 0.0;
    for (std::size_t i = 0; i < sighted.size(); ++i) {
      square_px2 += left.segment<2>(2 * static_cast<Eigen::Index>(i)).squaredNorm() * sighted[i].sigma_px *
                    sighted[i].sigma_px;
    }
    pose.rms_px = std::sqrt(square_px2 / static_cast<double>(left.size()));
    const double freedom = std::max(1.0, static_cast<double>(left.size()) - 6.0);
    const double scale = std::sqrt(std::max(1.0, left.squaredNorm() / freedom));
    const Eigen::Matrix<double, 6, 6> covariance =
        normal.solve(Eigen::Matrix<double, 6, 6>::Identity()) * (scale * scale);
    const Eigen::Matrix<double, 6, 6> root = covariance.llt().matrixL();
    for (Eigen::Index k = 0; k < 6; ++k) pose.modes.emplace_back(root.col(k));
    addPrintModes(face, scene, *j, normal, pose);
    addCameraModes(scene, *j, normal, pose);
    return pose;
  }
  return std::nullopt;
}

}  // namespace kerfbench::vision
