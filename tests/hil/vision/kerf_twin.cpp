// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/vision/kerf_twin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/scan/kerf_scan.h"
#include "tests/hil/vision/synthetic.h"
#include "twin/base/random.h"

namespace kerfbench::vision::test {
namespace {

using Eigen::Vector2d;

Vector2d leftOf(const Vector2d& tangent) { return {-tangent.y(), tangent.x()}; }

}  // namespace

twin::CameraDescription kerfCamera(double pitch_mm, double scale) {
  twin::CameraDescription camera;
  camera.width_px = static_cast<int>(1100 * scale);
  camera.height_px = static_cast<int>(800 * scale);
  camera.fx_px = 300.0 / pitch_mm;
  camera.fy_px = 1.001 * camera.fx_px;
  camera.cx_px = 0.5 * camera.width_px + 1.3;
  camera.cy_px = 0.5 * camera.height_px - 2.4;
  camera.distortion = {-0.02, 0.0, 1e-4, -1e-4, 0.0};
  camera.psf_sigma_px = 0.7;
  camera.X_CP = Eigen::Translation3d(0.0, 0.0, 300.0) *
                Eigen::AngleAxisd(std::numbers::pi + 0.009, Eigen::Vector3d(1.0, 0.002, 0.001).normalized());
  return camera;
}

CameraCalibration calibrationOf(const twin::CameraDescription& camera) {
  CameraCalibration c;
  c.width_px = camera.width_px;
  c.height_px = camera.height_px;
  c.fx_px = camera.fx_px;
  c.fy_px = camera.fy_px;
  c.cx_px = camera.cx_px;
  c.cy_px = camera.cy_px;
  c.distortion = camera.distortion;
  c.telecentric_mm = camera.telecentric_mm;
  c.X_CP = camera.X_CP;
  return c;
}

TwinCut::TwinCut() {
  board.thickness_mm = 1e-6;
  print.units = 1;
  print.pitch_mm = 80.0;
  for (const double x : {-17.0, 17.0}) {
    for (const double y : {-12.0, 12.0}) print.marks.push_back({{x, y + 0.02 * x}, 3.0});
  }
  options.station_pitch_mm = 0.1;
  options.beam_radius_mm = kBeamRadiusMm;
  options.beam_radius_sigma =
      0.01;  // As the beam is exactly what is told, wide uncertainties would hide errors.
}

int TwinCut::add(dieline::Curve curve, dieline::Process process) {
  const int id = static_cast<int>(dieline.entities.size());
  dieline.entities.push_back({id, std::move(curve), process, "", ""});
  return id;
}

void TwinCut::burn(twin::Sheet& sheet, const Vector2d& from_mm, const Vector2d& to_mm, double share) const {
  const double energy_j = share * board.cut_fluence_j_mm2 * kBeamRadiusMm *
                          std::sqrt(std::numbers::pi / 2.0) * (to_mm - from_mm).norm();
  sheet.burn({from_mm, kBeamRadiusMm, kBeamRadiusMm}, {to_mm, kBeamRadiusMm, kBeamRadiusMm}, energy_j);
}

void TwinCut::burn(twin::Sheet& sheet, const dieline::Curve& curve, double offset, double share) const {
  const bool straight = std::holds_alternative<dieline::LineCurve>(curve);
  const std::vector<double> us = straight ? std::vector{0.0, 1.0} : dieline::stations(curve, 0.02);
  const auto at = [&](double u) -> Vector2d {
    return dieline::pointAt(curve, u) + offset * leftOf(dieline::tangentAt(curve, u));
  };
  for (std::size_t i = 0; i + 1 < us.size(); ++i) burn(sheet, at(us[i]), at(us[i + 1]), share);
}

Eigen::Isometry2d TwinCut::lay() const {
  const CounterRandom random(seed, 77);
  return Eigen::Translation2d(2.0 * random.uniform(0) - 1.0, 2.0 * random.uniform(1) - 1.0) *
         Eigen::Rotation2Dd(0.01 * (random.uniform(2) - 0.5));
}

twin::Sheet TwinCut::sheet() const {
  twin::Sheet sheet(board);
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process == dieline::Process::kIgnore) continue;
    const auto offset = offset_mm.find(entity.id);
    const auto share = share_of.find(entity.id);
    if (share != share_of.end() && share->second == 0.0) continue;
    burn(sheet, entity.curve, offset == offset_mm.end() ? 0.0 : offset->second,
         share == share_of.end() ? fluence_share : share->second);
  }
  if (also) also(sheet);
  return sheet;
}

std::vector<camera::KerfTile> TwinCut::tiles() const {
  const twin::Sheet cut = sheet();
  const Vector2d p_TV_mm(0.3, -0.2);
  return {{twin::KerfCamera(camera, print, seed).render(cut, 0, p_TV_mm, lay()), p_TV_mm, 0}};
}

KerfScan TwinCut::scan() const { return scan(tiles()); }

KerfScan TwinCut::scan(std::vector<camera::KerfTile> some) const {
  ReadyTiles source(std::move(some));
  return scanKerf(source, calibrationOf(camera), print, dieline, options);
}

double TwinCut::truth(const KerfScan& scan, const Caliper& caliper, const dieline::Curve& curve,
                      double offset) const {
  const UnitPose& pose = scan.units.at(0);
  const Vector2d normal = leftOf(dieline::tangentAt(curve, caliper.u));
  const Eigen::Isometry2d X_TS = Eigen::Translation2d(pose.p_TS_mm) * Eigen::Rotation2Dd(pose.angle_rad);
  const double inside_mm = kBeamRadiusMm * kBeamRadiusMm / 8.0 * dieline::curvatureAt(curve, caliper.u);
  const Vector2d p_S_mm = X_TS.inverse() * (lay() * Vector2d(caliper.p_S_mm + (offset + inside_mm) * normal));
  return (p_S_mm - caliper.p_S_mm).dot(normal);
}

void Errors::add(const TwinCut& cut, const KerfScan& scan) {
  for (const EntityKerf& kerf : scan.entities) {
    const dieline::Entity& entity = cut.dieline.entities.at(static_cast<std::size_t>(kerf.entity));
    const auto told = cut.offset_mm.find(kerf.entity);
    const double offset = told == cut.offset_mm.end() ? 0.0 : told->second;
    std::vector<const Caliper*> good;
    double width = 0.0;
    for (const Caliper& c : kerf.calipers) {
      // The outermost half millimetre is end rather than kerf.
      if (!c.found || c.near_joint) continue;
      const bool open = !dieline::isClosed(entity.curve);
      if (open && (c.station_mm < 0.3 || c.station_mm > kerf.calipers.back().station_mm - 0.3)) continue;
      good.push_back(&c);
      width += c.width_mm;
    }
    for (const Caliper* c : good) {
      errors_mm_.push_back(c->offset_mm - cut.truth(scan, *c, entity.curve, offset));
      stated_mm_.push_back(c->sigma_mm);
      width_z_.push_back((c->width_mm - width / static_cast<double>(good.size())) / c->width_sigma_mm);
    }
  }
}

Honesty Errors::honesty() const {
  Honesty h{.count = errors_mm_.size()};
  const auto n = static_cast<double>(h.count);
  double squares = 0.0;
  for (std::size_t i = 0; i < h.count; ++i) {
    h.bias_mm += errors_mm_[i] / n;
    squares += errors_mm_[i] * errors_mm_[i] / n;
    h.stated_mm += stated_mm_[i] * stated_mm_[i] / n;
    h.z += errors_mm_[i] * errors_mm_[i] / (stated_mm_[i] * stated_mm_[i]) / n;
    h.width_z += width_z_[i] * width_z_[i] / n;
  }
  h.sigma_mm = std::sqrt(std::max(0.0, squares - h.bias_mm * h.bias_mm));
  h.stated_mm = std::sqrt(h.stated_mm);
  h.z = std::sqrt(h.z);
  h.width_z = std::sqrt(h.width_z);
  return h;
}

const EntityKerf& entityOf(const KerfScan& scan, int id, int unit) {
  return *std::find_if(scan.entities.begin(), scan.entities.end(),
                       [&](const EntityKerf& e) { return e.entity == id && e.unit == unit; });
}

}  // namespace kerfbench::vision::test
