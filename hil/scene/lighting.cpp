// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/lighting.h"

namespace kerfbench::scene {

Lighting lightingOf(const twin::Scene& scene, const Viewpoint& view) {
  using Eigen::Vector3d;
  const Vector3d centre = scene.overall.center();
  const double span = scene.overall.diagonal().norm();
  Vector3d toward = -view.forward();
  toward.z() = 0;
  if (toward.norm() < 1e-3) toward = -view.up();
  toward.normalize();
  const auto from = [&](double right, double near, double up) {
    return Vector3d(centre + span * (right * view.right() + near * toward + up * Vector3d::UnitZ()));
  };
  Lighting lighting;
  lighting.key_mm = from(-1.3, 1.1, 2.2);
  lighting.key_along_mm = 0.13 * span * view.right();
  lighting.key_across_mm = 0.13 * span * Vector3d(centre - lighting.key_mm).cross(view.right()).normalized();
  lighting.fill_mm = from(1.8, 0.7, 0.8);
  lighting.top_mm = from(-0.2, -0.9, 2.0);
  lighting.panel_mm = from(0.4, 0.7, 1.9);
  lighting.panel_half_mm = 0.55 * span;
  // The floor fades into the background: it has no edge.
  lighting.fog_mm = 50.0 * span;
  return lighting;
}

}  // namespace kerfbench::scene
