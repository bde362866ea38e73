// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/beam.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <Eigen/LU>

#include "twin/optics/scan_head.h"
#include "twin/optics/surface.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;

/// The machine with its board lifted by a little, still.
std::optional<twin::BeamSpot> spotAt(const twin::MachineDescription& machine, const Vector2d& command,
                                     double lift_mm) {
  twin::SurfaceDescription still = machine.surface;
  still.flutter_mm = 0.0;
  still.height_mm += lift_mm;
  const twin::Surface surface(still);
  if (machine.kind == twin::MachineDescription::Kind::kGantry)
    return twin::gantrySpot(command, machine.beam, surface, 0.0);
  return twin::ScanHead(machine.head, machine.beam).spotAt(command, Vector2d::Zero(), surface, 0.0);
}

}  // namespace

ArtefactBeam::ArtefactBeam(const twin::MachineDescription& machine, const Vector2d& p_W_mm)
    : noise(machine.laser.noise),
      noise_correlation_s(machine.laser.noise_correlation_s),
      drift(machine.laser.drift) {
  // Newton's method over the ray trace: which command puts the spot there does not matter otherwise.
  const bool gantry = machine.kind == twin::MachineDescription::Kind::kGantry;
  const double step = gantry ? 0.1 : 1e-4;
  Vector2d command = gantry ? p_W_mm : Vector2d(p_W_mm / (2.0 * machine.head.throw_mm));
  std::optional<twin::BeamSpot> spot = spotAt(machine, command, 0.0);
  for (int i = 0; i < 20 && spot && (spot->p_WQ_mm - p_W_mm).norm() > 1e-6; ++i) {
    const auto dx = spotAt(machine, command + Vector2d(step, 0.0), 0.0);
    const auto dy = spotAt(machine, command + Vector2d(0.0, step), 0.0);
    if (!dx || !dy) break;
    Eigen::Matrix2d slope;
    slope << (dx->p_WQ_mm - spot->p_WQ_mm) / step, (dy->p_WQ_mm - spot->p_WQ_mm) / step;
    command += slope.inverse() * (p_W_mm - spot->p_WQ_mm);
    spot = spotAt(machine, command, 0.0);
  }
  constexpr double kLift_mm = 0.1;
  const auto lifted = spotAt(machine, command, kLift_mm);
  if (!spot || !lifted || (spot->p_WQ_mm - p_W_mm).norm() > 1e-3)
    throw std::invalid_argument("gauge: the beam does not reach the artefact's place in the field");
  radius_x_mm = spot->radius_x_mm;
  radius_y_mm = spot->radius_y_mm;
  correlation = spot->correlation;
  shift_per_height_ = (lifted->p_WQ_mm - spot->p_WQ_mm) / kLift_mm;
  flutter_mm_ = machine.surface.flutter_mm;
  flutter_rad_s_ = 2.0 * std::numbers::pi * machine.surface.flutter_hz;
  flutter_phase_rad_ = machine.surface.flutter_phase_rad -
                       2.0 * std::numbers::pi * p_W_mm.x() / machine.surface.flutter_wavelength_mm;
}

Eigen::Matrix2d ArtefactBeam::covariance_mm2() const {
  Eigen::Matrix2d c;
  const double mixed = correlation * radius_x_mm * radius_y_mm;
  c << radius_x_mm * radius_x_mm, mixed, mixed, radius_y_mm * radius_y_mm;
  return 0.25 * c;
}

Vector2d ArtefactBeam::flutterShift_mm(double time_s) const {
  return flutter_mm_ * std::sin(flutter_rad_s_ * time_s + flutter_phase_rad_) * shift_per_height_;
}

}  // namespace kerfbench::gauge
