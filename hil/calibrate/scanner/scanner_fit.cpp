// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/scanner/scanner_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "hil/calibrate/camera/calibrate_camera.h"
#include "hil/calibrate/camera/picture_check.h"
#include "hil/calibrate/camera/target_finder.h"
#include "twin/base/image.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kKnot_mm = 8.0;         // A carriage's wobble is slower.
constexpr double kBend_mm = 0.2;         // Second difference of neighbouring splines, 1 sigma.
constexpr double kAnySpline_mm = 2.0;    // Splines themselves: what is common to them and A goes to A.
constexpr double kLeastSigma_px = 0.02;  // What a corner's fit cannot see.
constexpr double kLeastReach = 0.9;
constexpr double kMostScale = 0.03;
constexpr double kMostTurn_rad = 10.0 * std::numbers::pi / 180.0;
constexpr double kMostRms_px = 0.5;

/// Unknowns of one axis: its place, A's row, bar, carriage.
struct Columns {
  explicit Columns(const ScannerMap& map) : map_(map) {}
  [[nodiscard]] Index count() const { return 3 + ScannerMap::kBar + map_.carriage_mm.cols(); }
  [[nodiscard]] VectorXd at(const Vector2d& pixel) const {
    VectorXd row(count());
    row << 1.0, pixel / scale_px(), map_.barAt(pixel.x()), map_.carriageAt(pixel.y());
    return row;
  }
  /// Unit of the pixel's columns, so that all columns are about as large.
  [[nodiscard]] double scale_px() const { return map_.width_px; }

  const ScannerMap& map_;
};

/// The target as it lies, so that its y points up like that of the glass.
Vector2d onTarget(const TargetCorner& corner, const CalibrationTarget& target) {
  return target.square_mm * Vector2d(corner.column, -corner.row);
}

void requireReach(const std::vector<TargetCorner>& corners, const GrayImage& scan, std::string& faults) {
  Eigen::AlignedBox2d seen;
  for (const TargetCorner& corner : corners) seen.extend(corner.pixel);
  const Vector2d share = seen.sizes().cwiseQuotient(Vector2d(scan.width, scan.height));
  for (const int axis : {0, 1}) {
    if (share[axis] >= kLeastReach) continue;
    faults +=
        fmt::format("the target's corners reach over {:.0f} % of the glass along the {}; it takes {:.0f} %\n",
                    100.0 * share[axis], axis == 0 ? "sensor bar" : "carriage's way", 100.0 * kLeastReach);
  }
}

/// Information of priors on the splines, per axis.
MatrixXd priorOf(const Columns& columns, Index splines) {
  MatrixXd prior = MatrixXd::Zero(columns.count(), columns.count());
  const Index first = columns.count() - splines;
  for (Index k = 0; k < splines; ++k) prior(first + k, first + k) += 1.0 / (kAnySpline_mm * kAnySpline_mm);
  for (Index k = 1; k + 1 < splines; ++k) {
    VectorXd bend = VectorXd::Zero(columns.count());
    bend.segment<3>(first + k - 1) << 1.0, -2.0, 1.0;
    prior += bend * bend.transpose() / (kBend_mm * kBend_mm);
  }
  return prior;
}

struct Fitted {
  Eigen::MatrixX2d unknowns;
  MatrixXd covariance;  ///< Covariance of one axis, mm².
  double rms_mm{};
};

/// Weight of a corner, 1/mm²: as sharp as its picture shows it, but no sharper than the optics' own faults.
double weightOf(const TargetCorner& corner, double pitch_mm) {
  return 1.0 /
         (pitch_mm * pitch_mm * (0.5 * corner.covariance_px2.trace() + kLeastSigma_px * kLeastSigma_px));
}

Fitted fitted(const std::vector<TargetCorner>& corners, const CalibrationTarget& target,
              const Columns& columns, const MatrixXd& prior, double pitch_mm) {
  MatrixXd normal = prior;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(columns.count(), 2);
  for (const TargetCorner& corner : corners) {
    const VectorXd row = columns.at(corner.pixel);
    const double weight = weightOf(corner, pitch_mm);
    normal += weight * row * row.transpose();
    right += weight * row * onTarget(corner, target).transpose();
  }
  Fitted fit;
  const Eigen::LDLT<MatrixXd> factor(normal);
  fit.unknowns = factor.solve(right);
  fit.covariance = factor.solve(MatrixXd::Identity(columns.count(), columns.count()));
  double chi2 = 0.0, weights = 0.0;
  for (const TargetCorner& corner : corners) {
    const double weight = weightOf(corner, pitch_mm);
    const Vector2d left = onTarget(corner, target) - fit.unknowns.transpose() * columns.at(corner.pixel);
    chi2 += 0.5 * weight * left.squaredNorm();
    weights += weight;
  }
  fit.rms_mm = std::sqrt(chi2 / weights);
  const double freedom =
      std::max(1.0, static_cast<double>(corners.size()) - static_cast<double>(columns.count()));
  fit.covariance *= std::max(1.0, chi2 / freedom);
  return fit;
}

double largestSigma(const Fitted& fit, const Columns& columns, const GrayImage& scan) {
  constexpr int kSide = 15;
  double most = 0.0;
  for (int i = 0; i < kSide * kSide; ++i) {
    VectorXd row =
        columns.at({scan.width * (0.5 + i % kSide) / kSide, scan.height * (0.5 + i / kSide) / kSide});
    row[0] = 0.0;  // The target's place on the glass is nobody's error.
    const VectorXd middle = columns.at({0.5 * scan.width, 0.5 * scan.height});
    row.tail(row.size() - 1) -= middle.tail(row.size() - 1);
    most = std::max(most, row.dot(fit.covariance * row));
  }
  return std::sqrt(most);
}

}  // namespace

ScannerCalibration calibrateScanner(const GrayImage& scan, const ScannerJob& job) {
  if (const std::string fault = pictureFault(scan); !fault.empty())
    throw CalibrationError("the scan is " + fault);
  const TargetView view = findTarget(scan, job.target);
  if (!view.fault.empty()) throw CalibrationError("the target: " + view.fault);
  std::string faults;
  requireReach(view.corners, scan, faults);
  ScannerCalibration result{job.scanner_id,
                            job.date,
                            job.dpi,
                            ScannerMap::ofResolution(scan.width, scan.height, job.dpi),
                            0.0,
                            0.0,
                            view.corners.size()};
  ScannerMap& map = result.map;
  const double pitch_mm = kMmPerInch / job.dpi;
  const auto splines = 3 + static_cast<Index>(std::ceil(pitch_mm * scan.height / kKnot_mm));
  map.carriage_mm = Eigen::Matrix2Xd::Zero(2, splines);
  const Columns columns(map);
  const Fitted fit = fitted(view.corners, job.target, columns, priorOf(columns, splines), pitch_mm);
  const Eigen::Matrix2d made = fit.unknowns.middleRows<2>(1).transpose() / columns.scale_px();
  // The turn of the target: the bar's direction is that of x.
  const double turn = std::atan2(made(1, 0), made(0, 0));
  const Eigen::Matrix2d back = Eigen::Rotation2Dd(-turn).toRotationMatrix();
  map.mm_per_px = back * made;
  map.bar_mm = back * fit.unknowns.middleRows<ScannerMap::kBar>(3).transpose();
  map.carriage_mm = back * fit.unknowns.bottomRows(splines).transpose();
  result.rms_mm = fit.rms_mm;
  result.map_u_mm = largestSigma(fit, columns, scan);
  if (std::abs(turn) > kMostTurn_rad || map.mm_per_px(1, 1) >= 0.0) {
    faults += fmt::format(
        "the target lies turned by {:.0f}°, or mirrored: lay it face down, its rows along the bar\n",
        turn * 180.0 / std::numbers::pi);
  } else if (std::abs(map.pitchMm() / pitch_mm - 1.0) > kMostScale) {
    faults += fmt::format("by the target's squares the scan has {:.0f} dpi, not {:g}\n",
                          kMmPerInch / map.pitchMm(), job.dpi);
  }
  if (faults.empty() && fit.rms_mm > kMostRms_px * pitch_mm)
    faults += fmt::format("the corners leave {:.3f} mm RMS: the target lay uneven, or is not as described\n",
                          fit.rms_mm);
  if (!faults.empty()) throw CalibrationError(faults.substr(0, faults.size() - 1));
  return result;
}

}  // namespace kerfbench::calibrate
