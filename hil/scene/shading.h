// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/scene/lighting.h"
#include "hil/scene/mesh.h"
#include "hil/scene/raster.h"
#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// Red, green and blue, linear; 1 is white.
using Colour = Eigen::Array3d;

/// A look that is seen through: each layer lets `passes` of what is behind it pass, and adds the rest of
/// `colour`.
struct Clear {
  double passes{};
  Colour colour;
};
bool isClear(Look look);
Clear clearOf(Look look);

/// Shadows of the key lamp: what it sees, and how soft the edge of a shadow is.
class ShadowMap {
 public:
  ShadowMap(const Mesh& mesh, const Lighting& lighting);
  /// Share of the lamp that a point sees, 0 … 1. `normal`: of its face.
  [[nodiscard]] double lit(const Eigen::Vector3d& p_W_mm, const Eigen::Vector3d& normal) const;

 private:
  struct Plane;
  [[nodiscard]] double nearnessAt(int x, int y) const;
  [[nodiscard]] double litAt(const Plane& plane, const Eigen::Vector2d& p) const;

  Viewpoint view_;
  DepthRows rows_;
  double lamp_radius_mm_;
};

/// Colours of faces in the light of a scene's lamps, by the formulas and numbers of pov_materials.cpp, but
/// with shadows from a map, and with mirrors that see lamps and floor alone.
class Shading {
 public:
  Shading(const twin::Scene& scene, const Viewpoint& view, const Mesh& mesh);

  [[nodiscard]] Colour face(const Face& face, const Eigen::Vector3d& p_W_mm) const;
  /// What a ray from the viewpoint meets that meets no part: floor or background.
  [[nodiscard]] Colour beyond(const Eigen::Vector3d& direction) const;

 private:
  struct Finish;
  struct Lamp {
    Eigen::Vector3d place_mm;
    Colour colour;
  };
  static Finish finishOf(Look look);
  [[nodiscard]] Colour inLight(const Finish& finish, const Eigen::Vector3d& p_W_mm,
                               const Eigen::Vector3d& normal) const;
  [[nodiscard]] Colour reflected(const Eigen::Vector3d& p_W_mm, const Eigen::Vector3d& direction) const;
  [[nodiscard]] Colour inFog(const Colour& colour, double distance_mm) const;

  Lighting lighting_;
  Eigen::Vector3d eye_mm_;
  double floor_z_mm_;
  ShadowMap shadows_;
  std::vector<Lamp> fill_;
  Lamp spot_{};
  double spot_fade_mm_{};  ///< 0: the spot gives no light.
};

}  // namespace kerfbench::scene
