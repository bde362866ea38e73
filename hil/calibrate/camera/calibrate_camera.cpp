// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/calibrate_camera.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <opencv2/calib3d.hpp>

#include "hil/base/parallel.h"
#include "hil/calibrate/camera/bundle.h"
#include "hil/calibrate/camera/coverage.h"
#include "hil/calibrate/camera/map_covariance.h"
#include "hil/calibrate/files/day.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kStartCorners = 150;  // Fewest corners of each view, for the start.
constexpr double kOutlierSigmas = 6.0;
constexpr double kMostOutliers = 0.01;  // Share of all corners.
constexpr double kLeastTilt_rad = 10.0 * std::numbers::pi / 180.0;
constexpr double kMostFocalSigma = 0.01;  // Relative.

/// What is wrong, line by line.
class Faults {
 public:
  void add(const std::string& line) { text_ += (text_.empty() ? "" : "\n") + line; }
  void raise() const {
    if (!text_.empty()) throw CalibrationError(text_);
  }

 private:
  std::string text_;
};

void checkJob(const CalibrationJob& job, Faults& faults) {
  if (const std::string wrong = job.target.faults(); !wrong.empty()) faults.add("target: " + wrong);
  if (!job.place.p_PB_mm.allFinite() || !std::isfinite(job.place.turn_rad))
    faults.add("the place of the target in the first view is not finite");
  if (job.camera_id.empty()) faults.add("the camera has no id");
  if (!dayNumber(job.date)) faults.add(fmt::format("'{}' is no day like 2026-11-21", job.date));
  if (!(job.max_rms_px > 0.0 && job.max_rms_px <= 10.0))
    faults.add("the residuals' limit must be in (0, 10]");
  if (job.views.size() < kLeastViews)
    faults.add(fmt::format("{} views are too few: one in the plane and {} tilted ones at least",
                           job.views.size(), kLeastViews - 1));
}

TargetView lookAt(const CalibrationJob& job, std::size_t v) {
  TargetView view;
  try {
    const GrayImage image = job.picture(v);
    if (image.width == job.width_px && image.height == job.height_px) return findTarget(image, job.target);
    view.fault = fmt::format("is {} x {} pixels, the camera's pictures have {} x {}", image.width,
                             image.height, job.width_px, job.height_px);
  } catch (const std::exception& e) {
    view.fault = e.what();
  }
  return view;
}

std::vector<TargetView> lookAtAll(const CalibrationJob& job) {
  std::vector<TargetView> views(job.views.size());
  std::mutex telling;
  base::forEachIndex(job.views.size(), job.threads, [&](std::size_t v) {
    views[v] = lookAt(job, v);
    const std::lock_guard lock(telling);
    if (job.done) job.done(v);
  });
  return views;
}

/// OpenCV solves by whatever BLAS a system has, and its last digits differ. A start that is rounded is the
/// same everywhere, and so is all that follows from it.
double rounded(double value, double grid) { return grid * std::round(value / grid); }

constexpr double kStartGridPx = 1e-2;
constexpr double kStartGridMm = 1e-2;
constexpr double kStartGrid = 1e-4;  ///< Step of the first search, for angles (rad) and distortion.

Bundle pointsOf(const CalibrationJob& job, const std::vector<TargetView>& views) {
  Bundle bundle;
  for (const TargetView& view : views) {
    std::vector<BundlePoint>& points = bundle.points.emplace_back();
    for (const TargetCorner& corner : view.corners)
      points.push_back(
          {job.target.square_mm * Vector2d(corner.column, corner.row), corner.pixel, corner.covariance_px2});
  }
  return bundle;
}

/// A start near enough for the bundle: OpenCV's, on some of the corners.
Bundle pinholeStart(const CalibrationJob& job, const std::vector<TargetView>& views) {
  std::vector<std::vector<cv::Point3f>> board(views.size());
  std::vector<std::vector<cv::Point2f>> picture(views.size());
  Bundle bundle = pointsOf(job, views);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const std::vector<BundlePoint>& points = bundle.points[v];
    const std::size_t used = std::min(points.size(), kStartCorners);
    for (std::size_t i = 0; i < used; ++i) {
      const BundlePoint& p = points[i * points.size() / used];
      board[v].emplace_back(static_cast<float>(p.p_B_mm.x()), static_cast<float>(p.p_B_mm.y()), 0.0F);
      picture[v].emplace_back(static_cast<float>(p.pixel.x()), static_cast<float>(p.pixel.y()));
    }
  }
  cv::Mat k;
  cv::Mat distortion;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  cv::calibrateCamera(board, picture, {job.width_px, job.height_px}, k, distortion, turns, shifts,
                      cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST,
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-9));
  const auto pixels = [&](int row, int column) { return rounded(k.at<double>(row, column), kStartGridPx); };
  bundle.lens.pinhole << pixels(0, 0), pixels(1, 1), pixels(0, 2), pixels(1, 2);
  bundle.lens.distortion[0] = rounded(distortion.at<double>(0), kStartGrid);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto angle = [&](int i) { return rounded(turns[v].at<double>(i), kStartGrid); };
    const auto length = [&](int i) { return rounded(shifts[v].at<double>(i), kStartGridMm); };
    const Vector3d turn(angle(0), angle(1), angle(2));
    Isometry3d X_CB = Isometry3d::Identity();
    if (turn.norm() > 0.0)
      X_CB.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    X_CB.translation() << length(0), length(1), length(2);
    bundle.X_CB.push_back(X_CB);
  }
  return bundle;
}

/// The affine map from a target to its view: pixel = linear * p + shift, by least squares.
struct AffineView {
  Eigen::Matrix2d linear;
  Vector2d shift;
};

AffineView affineOf(const std::vector<BundlePoint>& points) {
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (const BundlePoint& point : points) {
    const Vector3d p = point.p_B_mm.homogeneous();
    square += p * p.transpose();
    right += p * point.pixel.transpose();
  }
  const Eigen::Matrix<double, 2, 3> map = square.ldlt().solve(right).transpose();
  return {map.leftCols<2>(), map.col(2)};
}

/// A start for a telecentric lens without distortion: each view is an affine map, the scale is the largest of
/// all their singular values, since no tilt enlarges, and the other singular value tells the tilt, but not to
/// which of two sides; both fit alike.
Bundle telecentricStart(const CalibrationJob& job, const std::vector<TargetView>& views) {
  Bundle bundle = pointsOf(job, views);
  std::vector<AffineView> maps;
  double scale = 0.0;
  for (const auto& points : bundle.points) {
    maps.push_back(affineOf(points));
    scale = std::max(scale, maps.back().linear.jacobiSvd().singularValues()[0]);
  }
  const double focal_px = rounded(scale * job.telecentric_mm, kStartGridPx);
  const Vector2d centre_px(0.5 * (job.width_px - 1), 0.5 * (job.height_px - 1));
  bundle.lens.telecentric_mm = job.telecentric_mm;
  bundle.lens.pinhole << focal_px, focal_px, centre_px;
  for (const AffineView& map : maps) {
    Eigen::Matrix<double, 3, 2> axes = Eigen::Matrix<double, 3, 2>::Zero();
    axes.topRows<2>() = map.linear * job.telecentric_mm / focal_px;
    // The third row makes unit vectors of both columns that are square to each other.
    const double x = std::sqrt(std::max(0.0, 1.0 - axes.col(0).squaredNorm()));
    const double y = std::sqrt(std::max(0.0, 1.0 - axes.col(1).squaredNorm()));
    axes.row(2) << x, axes.topRows<2>().col(0).dot(axes.topRows<2>().col(1)) > 0.0 ? -y : y;
    Eigen::Matrix3d turn;
    turn << axes, axes.col(0).cross(axes.col(1));
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Isometry3d X_CB = Isometry3d::Identity();
    X_CB.linear() = svd.matrixU() * svd.matrixV().transpose();
    X_CB.translation() << (map.shift - centre_px) * job.telecentric_mm / focal_px, 0.0;
    // Far enough that all of a tilted target lies before the camera.
    X_CB.translation().z() = job.telecentric_mm + job.target.size_mm().norm();
    bundle.X_CB.push_back(X_CB);
  }
  return bundle;
}

Bundle startOf(const CalibrationJob& job, const std::vector<TargetView>& views) {
  return job.telecentric_mm > 0.0 ? telecentricStart(job, views) : pinholeStart(job, views);
}

/// Takes corners out that are far from where all others put them. Returns how many.
std::size_t dropOutliers(const BundleResult& result, std::vector<TargetView>& views, Bundle& bundle) {
  std::size_t dropped = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    // Scatter by the median: outliers are in sigma_px.
    std::vector<double> sizes;
    for (const Vector2d& r : result.residuals_px[v]) sizes.push_back(r.norm());
    /// Median of a Rayleigh law.
    const double limit_px = std::max(kOutlierSigmas * upperMedianIn(sizes) / 1.1774, 1e-6);
    std::vector<TargetCorner> corners;
    std::vector<BundlePoint> points;
    for (std::size_t i = 0; i < views[v].corners.size(); ++i) {
      if (result.residuals_px[v][i].norm() > limit_px) {
        ++dropped;
        continue;
      }
      corners.push_back(views[v].corners[i]);
      points.push_back(bundle.points[v][i]);
    }
    views[v].corners = std::move(corners);
    bundle.points[v] = std::move(points);
  }
  return dropped;
}

/// Whether of all corners, and in every view enough are left.
bool fewEnough(std::size_t outliers, const std::vector<TargetView>& views) {
  std::size_t left = 0;
  for (const TargetView& view : views) {
    if (static_cast<int>(view.corners.size()) < kLeastCorners) return false;
    left += view.corners.size();
  }
  return static_cast<double>(outliers) <= kMostOutliers * static_cast<double>(left + outliers);
}

double angleBetween(const Isometry3d& a, const Isometry3d& b) {
  return std::acos(std::clamp(a.linear().col(2).dot(b.linear().col(2)), -1.0, 1.0));
}

void checkResult(const CalibrationJob& job, const BundleResult& result, Faults& faults) {
  double widest_rad = 0.0;
  for (const Isometry3d& a : result.X_CB) {
    for (const Isometry3d& b : result.X_CB) widest_rad = std::max(widest_rad, angleBetween(a, b));
  }
  const bool finite = result.covariance.allFinite() && result.lens.pinhole.allFinite();
  const double focal_sigma =
      finite ? std::sqrt(result.covariance(0, 0)) / std::abs(result.lens.pinhole[0]) : HUGE_VAL;
  if (widest_rad < kLeastTilt_rad) {
    faults.add(
        fmt::format("all views show the target at the same angle, within {:.1f}°: tilt it by 20 … 40° in "
                    "several directions, or focal length and distance cannot be told apart",
                    180.0 / std::numbers::pi * widest_rad));
  } else if (!result.settled || !finite || !(focal_sigma < kMostFocalSigma)) {
    faults.add("the views do not fix the lens: tilt the target in more directions, over the whole picture");
  }
  if (!(result.rms_px <= job.max_rms_px)) {
    faults.add(
        fmt::format("the corners are {:.3f} px (RMS per axis) from where the lens puts them, at most {}: the "
                    "target is not "
                    "flat, not as described, or moved while a picture was taken",
                    result.rms_px, job.max_rms_px));
  }
}

Isometry3d targetInPlane(const TargetPlace& place) {
  // Face up: z of B, into the paper, is -z of P.
  Eigen::Matrix3d face;
  face << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  Isometry3d X_PB = Isometry3d::Identity();
  X_PB.linear() = Eigen::AngleAxisd(place.turn_rad, Vector3d::UnitZ()).toRotationMatrix() * face;
  X_PB.translation() << place.p_PB_mm, 0.0;
  return X_PB;
}

/// Covariance of lens and plane, from that of lens and the first view's target. The plane's origin moves with
/// a turn of the target about the target's own.
Eigen::Matrix<double, 15, 15> planeCovariance(const BundleResult& result, const Isometry3d& X_BP) {
  Eigen::Matrix<double, 15, 15> to_plane = Eigen::Matrix<double, 15, 15>::Identity();
  const Vector3d arm = result.X_CB.front().linear() * X_BP.translation();
  Eigen::Matrix3d turned;
  turned << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;  // d x arm as a matrix of d.
  to_plane.block<3, 3>(12, 9) = turned;
  return to_plane * result.covariance.topLeftCorner<15, 15>() * to_plane.transpose();
}

/// Bound (95 %) of the tilt of a telecentric first view. A tilt by a shortens one direction by cos a; how far
/// below one that may be follows from the focal lengths' uncertainty and that of the view's own corners.
double squareWithin(const BundleResult& result, const TargetView& first) {
  const double tilt_rad = std::acos(std::min(1.0, std::abs(result.X_CB.front().linear()(2, 2))));
  const double focal_share =
      std::sqrt(result.covariance(0, 0) + result.covariance(1, 1)) / std::abs(result.lens.pinhole[0]);
  double spread_px2 = 0.0;
  Eigen::AlignedBox2d box;
  for (const TargetCorner& corner : first.corners) box.extend(corner.pixel);
  for (const TargetCorner& corner : first.corners) spread_px2 += (corner.pixel - box.center()).squaredNorm();
  const double corners_share = result.sigma_px.front() / std::sqrt(0.5 * spread_px2);
  return std::sqrt(tilt_rad * tilt_rad + 4.0 * std::hypot(focal_share, corners_share));
}

vision::CameraCalibration calibrationFrom(const CalibrationJob& job, const BundleResult& result,
                                          const std::vector<TargetView>& views) {
  const Isometry3d X_PB = targetInPlane(job.place);
  vision::CameraCalibration c;
  c.width_px = job.width_px;
  c.height_px = job.height_px;
  c.fx_px = result.lens.pinhole[0];
  c.fy_px = result.lens.pinhole[1];
  c.cx_px = result.lens.pinhole[2];
  c.cy_px = result.lens.pinhole[3];
  c.distortion = result.lens.distortion;
  c.telecentric_mm = job.telecentric_mm;
  c.X_CP = result.X_CB.front() * X_PB.inverse();
  c.camera_id = job.camera_id;
  c.date = job.date;
  c.rms_px = result.rms_px;
  for (const TargetCorner& corner : views.front().corners) {
    const Vector2d p_B_mm = job.target.square_mm * Vector2d(corner.column, corner.row);
    c.area_mm.extend(Vector2d((X_PB * Vector3d(p_B_mm.x(), p_B_mm.y(), 0.0)).head<2>()));
  }
  setMapCovariance(planeCovariance(result, X_PB.inverse()), c);
  if (c.telecentric_mm > 0.0) c.square_within_rad = squareWithin(result, views.front());
  return c;
}

}  // namespace

CameraCalibrationResult calibrateCamera(const CalibrationJob& job) {
  Faults faults;
  checkJob(job, faults);
  if (!job.target.faults().empty()) faults.raise();
  std::vector<TargetView> views = lookAtAll(job);
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!views[v].fault.empty()) faults.add(job.views[v] + ": " + views[v].fault);
  }
  if (!views.empty() && views.front().fault.empty()) {
    const std::string bare = coverageFault(views.front().corners, job.width_px, job.height_px);
    if (!bare.empty()) faults.add(job.views.front() + ": " + bare);
  }
  faults.raise();

  BundleResult result;
  std::size_t outliers = 0;
  try {
    Bundle bundle = startOf(job, views);
    result = adjust(bundle);
    outliers = dropOutliers(result, views, bundle);
    bundle.lens = result.lens;
    bundle.X_CB = result.X_CB;
    if (outliers > 0 && fewEnough(outliers, views)) result = adjust(bundle);
  } catch (const cv::Exception&) {
    throw CalibrationError("the views do not fix the lens: tilt the target in more directions");
  }
  CameraCalibrationResult out;
  for (const TargetView& view : views) out.corners += view.corners.size();
  out.outliers = outliers;
  checkResult(job, result, faults);
  if (!fewEnough(outliers, views)) {
    faults.add(fmt::format("{} of {} corners do not fit with the others", outliers, out.corners + outliers));
  }
  faults.raise();
  out.calibration = calibrationFrom(job, result, views);
  for (std::size_t v = 0; v < views.size(); ++v) {
    out.views.push_back({job.views[v], views[v].corners, result.residuals_px[v], result.sigma_px[v],
                         views[v].blur_px, angleBetween(result.X_CB[v], result.X_CB.front())});
  }
  return out;
}

}  // namespace kerfbench::calibrate
