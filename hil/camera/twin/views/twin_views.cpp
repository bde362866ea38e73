// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/views/twin_views.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "hil/calibrate/camera/target_print.h"
#include "twin/camera/target_camera.h"

namespace kerfbench::camera {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSquare_px = 50.0;
constexpr double kMargin = 0.08;  // Margin of the target beyond the picture, a share of its side.
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kPlaneTurn_rad = 2.0 * kDegree;  // Corners then lie anywhere in their pixels.

/// Where the camera's axis meets its plane: the distance, and the point.
double distanceOf(const twin::CameraDescription& camera) {
  const Vector3d normal = camera.X_CP.linear().col(2);
  return normal.dot(camera.X_CP.translation()) / normal.z();
}

Vector2d pitchOf(const twin::CameraDescription& camera) {
  return (camera.telecentric_mm > 0.0 ? camera.telecentric_mm : distanceOf(camera)) *
         Vector2d(1.0 / camera.fx_px, 1.0 / camera.fy_px);
}

}  // namespace

calibrate::CalibrationTarget targetOf(const twin::CameraDescription& camera) {
  const Vector2d pitch_mm = pitchOf(camera);
  const Vector2d field_mm = pitch_mm.cwiseProduct(Vector2d(camera.width_px, camera.height_px));
  return calibrate::targetFor(field_mm, kMargin, kSquare_px * pitch_mm.maxCoeff());
}

TwinViews twinViews(const twin::CameraDescription& camera, const calibrate::CalibrationTarget& target,
                    int tilted) {
  TwinViews views;
  views.target = target;
  const double distance_mm = distanceOf(camera);
  const Vector3d p_CM(0.0, 0.0, distance_mm);
  const Vector2d middle_mm = (camera.X_CP.inverse() * p_CM).head<2>();
  const Eigen::Translation3d to_middle(-0.5 * target.size_mm().x(), -0.5 * target.size_mm().y(), 0.0);

  Eigen::Matrix3d face;
  face << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  Isometry3d X_PB = Isometry3d::Identity();
  X_PB.linear() = Eigen::AngleAxisd(kPlaneTurn_rad, Vector3d::UnitZ()).toRotationMatrix() * face;
  X_PB.translation() << middle_mm, 0.0;
  X_PB = X_PB * to_middle;
  views.place.p_PB_mm = X_PB.translation().head<2>();
  views.place.turn_rad = kPlaneTurn_rad;
  views.X_CB.push_back(camera.X_CP * X_PB);

  constexpr std::array<double, 3> kTilt{30.0, 20.0, 35.0};
  constexpr std::array<double, 2> kDistance{0.96, 1.05};
  for (int i = 0; i < tilted; ++i) {
    const double azimuth_rad = 2.0 * std::numbers::pi * (i + 0.3) / tilted;
    const Vector3d axis(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0);
    const auto n = static_cast<std::size_t>(i);
    const Eigen::AngleAxisd tilt(kTilt.at(n % kTilt.size()) * kDegree, axis);
    const Eigen::AngleAxisd turn((90.0 * i + 7.0) * kDegree, Vector3d::UnitZ());
    views.X_CB.emplace_back(Eigen::Translation3d(0.0, 0.0, distance_mm * kDistance.at(n % kDistance.size())) *
                            tilt * turn * to_middle);
  }
  return views;
}

twin::TargetBoard boardOf(const calibrate::CalibrationTarget& target) {
  twin::TargetBoard board;
  board.columns = target.columns;
  board.rows = target.rows;
  board.square_mm = target.square_mm;
  board.margin_mm = target.square_mm;
  board.marker_mm = target.marker_mm;
  board.marker_cells = calibrate::CalibrationTarget::kMarkerCells;
  for (int id = 0; id < target.markers(); ++id) {
    const Eigen::Vector2i square = target.squareOf(id);
    board.markers.push_back({square.x(), square.y(), calibrate::markerCells(id)});
  }
  return board;
}

void setTwinViews(const twin::CameraDescription& camera, const TwinViews& views, std::uint64_t seed,
                  calibrate::CalibrationJob& job) {
  job.target = views.target;
  job.place = views.place;
  job.width_px = camera.width_px;
  job.height_px = camera.height_px;
  job.telecentric_mm = camera.telecentric_mm;
  job.views.clear();
  for (std::size_t v = 0; v < views.X_CB.size(); ++v) job.views.push_back(fmt::format("view {}", v));
  const auto eye = std::make_shared<twin::TargetCamera>(camera, boardOf(views.target), seed);
  job.picture = [eye, X_CB = views.X_CB](std::size_t v) { return eye->render(X_CB.at(v), v); };
}

}  // namespace kerfbench::camera
