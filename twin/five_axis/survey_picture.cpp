// SPDX-License-Identifier: Apache-2.0
#include "twin/five_axis/survey_picture.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>

#include "twin/base/image.h"

namespace kerfbench::twin {
namespace {

constexpr double kDark_gray = 12.0;  // Room behind the blank.

/// Picture of a plane without end.
GrayImage planePicture(CameraDescription camera, const Eigen::Isometry3d& X_WF, const PrintLayout& print,
                       std::uint64_t seed) {
  camera.X_CP = camera.X_CP * X_WF;
  Exposure exposure;
  exposure.sequence = 1;
  exposure.samples.emplace_back();
  return SpotCamera(camera, print, 1.0, seed).render(exposure).image;
}

/// A face as its pixels see it.
struct SeenFace {
  Eigen::Matrix3d F_from_pixel;  ///< Homogeneous; the third component is 1 / depth.
  Eigen::AlignedBox2d outline_F_mm;
  GrayImage picture;
};

}  // namespace

GrayImage surveyPicture(const CameraDescription& camera, const std::vector<BlankFace>& faces,
                        std::uint64_t seed) {
  if (camera.telecentric_mm > 0.0 ||
      std::ranges::any_of(camera.distortion, [](double k) { return k != 0.0; }))
    throw std::invalid_argument("surveyPicture: the lens must be a pinhole without distortion");
  Eigen::Matrix3d intrinsic;
  intrinsic << camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0;
  std::vector<SeenFace> seen;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Eigen::Isometry3d X_CF = camera.X_CP * faces[i].X_WF;
    // Behind the face or edge-on: nothing of it is seen.
    if (X_CF.linear().col(2).dot(X_CF.translation()) > -1e-3) continue;
    Eigen::Matrix3d pixel_from_F;
    pixel_from_F << X_CF.linear().leftCols<2>(), X_CF.translation();
    pixel_from_F = intrinsic * pixel_from_F;
    seen.push_back({pixel_from_F.inverse(), faces[i].outline_F_mm,
                    planePicture(camera, faces[i].X_WF, faces[i].print, seed + i)});
  }
  CameraDescription dark = camera;
  dark.board_gray = kDark_gray;
  PrintLayout nothing;
  nothing.pitch_mm = 1.0;
  Eigen::Isometry3d facing = camera.X_CP.inverse();
  facing.linear() = facing.linear() * Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
  facing.translation() += camera.X_CP.inverse().linear().col(2) * 1000.0;
  GrayImage picture = planePicture(dark, facing, nothing, seed + faces.size());
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      double nearest = 0.0;  // 1 / depth.
      const SeenFace* face = nullptr;
      for (const SeenFace& f : seen) {
        const Eigen::Vector3d q = f.F_from_pixel * Eigen::Vector3d(column, row, 1.0);
        if (q.z() <= nearest || !f.outline_F_mm.contains(Eigen::Vector2d(q.head<2>() / q.z()))) continue;
        nearest = q.z();
        face = &f;
      }
      if (face == nullptr) continue;
      const std::size_t i = picture.index(column, row);
      picture.pixels[i] = face->picture.pixels[i];
      if (!picture.levels.empty()) picture.levels[i] = face->picture.levels[i];
    }
  }
  return picture;
}

}  // namespace kerfbench::twin
