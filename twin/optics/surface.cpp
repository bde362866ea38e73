// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kerfbench::twin {
namespace {

constexpr int kMostSteps = 50;
constexpr double kClose_mm = 0.5e-12;
constexpr double kSmall_mm = 1e-3;  // Step over which the slope changes linearly.
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

bool isZero(const std::array<double, 2>& pair) { return pair[0] == 0 && pair[1] == 0; }

const SurfaceDescription& checked(const SurfaceDescription& description) {
  const std::string faults = faultsOf(description);
  if (!faults.empty()) throw std::invalid_argument(faults);
  return description;
}

}  // namespace

Surface::Surface(const SurfaceDescription& description)
    : description_(checked(description)),
      wave_rad_mm_(kTurn_rad / description.flutter_wavelength_mm),
      most_bend_1_mm_(
          std::max(std::abs(description.curvature_1_mm[0]), std::abs(description.curvature_1_mm[1])) +
          description.flutter_mm * wave_rad_mm_ * wave_rad_mm_),
      level_(isZero(description.slope) && isZero(description.curvature_1_mm) && description.flutter_mm == 0),
      plane_(isZero(description.curvature_1_mm) && description.flutter_mm == 0) {}

double Surface::height_mm(const Eigen::Vector2d& p_WQ_mm, double time_s) const {
  return localAt(p_WQ_mm, time_s).height_mm;
}

SurfacePoint Surface::at(const Eigen::Vector2d& p_WQ_mm, double time_s) const {
  const Local local = localAt(p_WQ_mm, time_s);
  return {p_WQ_mm, local.height_mm, local.slope};
}

Surface::Local Surface::localAt(const Eigen::Vector2d& p_WQ_mm, double time_s) const {
  const SurfaceDescription& s = description_;
  const double x = p_WQ_mm.x();
  const double y = p_WQ_mm.y();
  const Eigen::Vector2d bend(s.curvature_1_mm[0], s.curvature_1_mm[1]);
  Local local{s.height_mm + (s.slope[0] + 0.5 * bend.x() * x) * x + (s.slope[1] + 0.5 * bend.y() * y) * y,
              {s.slope[0] + bend.x() * x, s.slope[1] + bend.y() * y},
              bend};
  if (s.flutter_mm > 0) {
    const double phase = kTurn_rad * s.flutter_hz * time_s - wave_rad_mm_ * x + s.flutter_phase_rad;
    const double wave_mm = s.flutter_mm * std::sin(phase);
    local.height_mm += wave_mm;
    local.slope.x() -= s.flutter_mm * wave_rad_mm_ * std::cos(phase);
    local.bend_1_mm.x() -= wave_rad_mm_ * wave_rad_mm_ * wave_mm;
  }
  return local;
}

std::optional<SurfacePoint> Surface::meet(const Eigen::Vector2d& foot_W_mm, const Eigen::Vector2d& run,
                                          double time_s) const {
  const double level_mm = description_.height_mm;
  if (level_) return SurfacePoint{foot_W_mm + level_mm * run, level_mm, Eigen::Vector2d::Zero()};
  if (plane_) {
    const Eigen::Vector2d slope(description_.slope[0], description_.slope[1]);
    const double z = (level_mm + slope.dot(foot_W_mm)) / (1.0 - slope.dot(run));
    return SurfacePoint{foot_W_mm + z * run, z, slope};
  }
  const double most_bend = most_bend_1_mm_ * run.squaredNorm();
  double z = level_mm;
  for (int i = 0; i < kMostSteps; ++i) {
    const Local local = localAt(foot_W_mm + z * run, time_s);
    const double rate = 1.0 - local.slope.dot(run);
    const double step = (local.height_mm - z) / rate;
    z += step;
    // Bound on the error after a step of Newton's method, by Kantorovich's theorem: the surface at the new
    // place need not be computed.
    const double left_mm = most_bend / std::abs(rate) * step * step;
    if (std::abs(step) <= kSmall_mm && left_mm <= kClose_mm) {
      return SurfacePoint{foot_W_mm + z * run, z, local.slope + step * local.bend_1_mm.cwiseProduct(run)};
    }
  }
  return std::nullopt;
}

}  // namespace kerfbench::twin
