// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/checks/start_place.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"

namespace kerfbench::inspect::checks {
namespace {

/// Lines are never taken to keep to one displacement better than that: steps and servo make each this rough.
constexpr double kLeastScatter_mm = 0.005;

/// Deviations of one line, across it.
struct LineDeviations {
  Eigen::Matrix2d normal{Eigen::Matrix2d::Zero()};  ///< Sum of n nᵀ over its frames.
  Eigen::Vector2d right{Eigen::Vector2d::Zero()};   ///< Sum of n times deviation.
  double square_mm2{};                              ///< Sum of the deviations' squares.
  double frames{};

  [[nodiscard]] double missSquare_mm2(const Eigen::Vector2d& d_mm) const {
    return std::max(0.0, (square_mm2 - 2.0 * d_mm.dot(right) + d_mm.dot(normal * d_mm)) / frames);
  }
};

using UnitLines = std::map<int, LineDeviations>;  ///< Key: entity.

std::map<int, UnitLines> deviationsOf(const Evidence& evidence, const LitFrames& lit) {
  std::map<int, UnitLines> units;
  for (const LitFrame& frame : lit.frames) {
    if (frame.entity < 0 || frame.ambiguous || !std::isfinite(frame.deviation_mm)) continue;
    const dieline::Curve& curve = entityOf(evidence, frame.entity).curve;
    const Eigen::Vector2d tangent = dieline::tangentAt(curve, dieline::nearestOn(curve, frame.p_S_mm).u);
    const Eigen::Vector2d normal(-tangent.y(), tangent.x());
    LineDeviations& line = units[frame.unit][frame.entity];
    line.normal += normal * normal.transpose();
    line.right += normal * frame.deviation_mm;
    line.square_mm2 += frame.deviation_mm * frame.deviation_mm;
    line.frames += 1.0;
  }
  return units;
}

/// The largest deviation that was read on a unit: RMS of a line across it, or of an end along its line.
double largestOf(const std::vector<JointResult>& joints, int unit, const UnitLines& lines) {
  double largest_mm = kLeastScatter_mm;
  for (const auto& [entity, line] : lines)
    largest_mm = std::max(largest_mm, std::sqrt(line.square_mm2 / line.frames));
  for (const JointResult& joint : joints) {
    if (joint.kind == JointResult::Kind::kEndGap && joint.unit == unit && std::isfinite(joint.mm.value))
      largest_mm = std::max(largest_mm, std::abs(joint.mm.value));
  }
  return largest_mm;
}

}  // namespace

Displacements::Displacements(const Evidence& evidence, const std::vector<JointResult>& joints,
                             const Tolerances& limits, const LitFrames& lit) {
  for (const auto& [unit, lines] : deviationsOf(evidence, lit)) {
    const double prior_mm = 0.5 * std::min(largestOf(joints, unit, lines), limits.path_mm);
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    // Each line counts once: its frames share its error.
    for (const auto& [entity, line] : lines) {
      normal += line.normal / line.frames;
      right += line.right / line.frames;
    }
    Fit fit;
    double scatter_mm = kLeastScatter_mm;
    // The scatter weighs what was read against what was known before; it follows from a first fit.
    for (int i = 0; i < 2; ++i) {
      const double weight = 1.0 / (scatter_mm * scatter_mm);
      const Eigen::Matrix2d information =
          weight * normal + Eigen::Matrix2d::Identity() / (prior_mm * prior_mm);
      fit.covariance = information.inverse();
      fit.mm = fit.covariance * (weight * right);
      double square_mm2 = 0.0;
      for (const auto& [entity, line] : lines) square_mm2 += line.missSquare_mm2(fit.mm);
      fit.scatter_mm = std::max(scatter_mm, std::sqrt(square_mm2 / static_cast<double>(lines.size())));
      scatter_mm = fit.scatter_mm;
    }
    fits_.emplace(unit, fit);
  }
}

StartPlace Displacements::along(int unit, const Eigen::Vector2d& direction) const {
  const Fit& fit = fits_.at(unit);
  return {fit.mm.dot(direction),
          std::hypot(std::sqrt(direction.dot(fit.covariance * direction)), fit.scatter_mm)};
}

std::optional<StartPlace> kerfStart(const std::vector<JointResult>& joints, int unit, int entity,
                                    bool at_start) {
  for (const JointResult& joint : joints) {
    const bool own = joint.kind == JointResult::Kind::kEndGap && joint.unit == unit &&
                     joint.entity == entity && joint.at_start == at_start;
    if (own && std::isfinite(joint.mm.value) && joint.mm.U > 0.0)
      return StartPlace{joint.mm.value, 0.5 * joint.mm.U};
  }
  return std::nullopt;
}

}  // namespace kerfbench::inspect::checks
