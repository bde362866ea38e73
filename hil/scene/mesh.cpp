// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <variant>

namespace kerfbench::scene {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using twin::Material;

Look lookOf(Material material) {
  // The looks of parts stand in the order of the materials.
  static_assert(static_cast<int>(Look::kSteel) == static_cast<int>(Material::kSteel));
  static_assert(static_cast<int>(Look::kMirror) == static_cast<int>(Material::kMirror));
  static_assert(static_cast<int>(Look::kLight) == static_cast<int>(Material::kLight));
  return static_cast<Look>(material);
}

/// Adds the faces of one part.
class PartMesh {
 public:
  PartMesh(Mesh& mesh, Look look, const Isometry3d& X_WP) : mesh_(mesh), look_(look), X_WP_(X_WP) {}

  void operator()(const twin::Box& box) {
    const Vector3d half = 0.5 * box.size_mm;
    const double edge = std::clamp(box.edge_radius_mm, 0.0, 0.49 * box.size_mm.minCoeff());
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const Vector3d normal = side * Vector3d::Unit(axis);
        const Vector3d a = half[(axis + 1) % 3] * Vector3d::Unit((axis + 1) % 3);
        const Vector3d b = side * half[(axis + 2) % 3] * Vector3d::Unit((axis + 2) % 3);
        const Vector3d middle = half[axis] * normal;
        beginFlat(normal);
        if (edge > 0) {
          mesh_.faces.back().kind = Face::Kind::kRoundedEdge;
          mesh_.faces.back().core_mm = half - Vector3d::Constant(edge);
        }
        quad({middle - a - b, middle + a - b, middle + a + b, middle - a + b});
      }
    }
  }

  void operator()(const twin::Cylinder& c) {
    const double top = 0.5 * c.length_mm;
    wall(Vector2d::Constant(c.radius_mm), {-top, top}, false);
    if (c.bore_mm > 0) wall(Vector2d::Constant(c.bore_mm), {-top, top}, true);
    for (const double side : {-1.0, 1.0}) {
      beginFlat(side * Vector3d::UnitZ());
      end(Vector2d::Constant(c.radius_mm), c.bore_mm / c.radius_mm, side * top, side > 0);
    }
  }

  void operator()(const twin::Disc& disc) {
    beginFlat(Vector3d::UnitZ());
    end(disc.radius_mm, 0.0, 0.0, true);
    // Printed marks and holes of the belt are so thin that nobody sees their rim.
    constexpr double kThin = 0.02;
    if (disc.thickness_mm < kThin * disc.radius_mm.minCoeff()) return;
    beginFlat(-Vector3d::UnitZ());
    end(disc.radius_mm, 0.0, -disc.thickness_mm, false);
    wall(disc.radius_mm, {-disc.thickness_mm, 0.0}, false);
  }

  void operator()(const twin::Cone& cone) {
    beginFlat(-Vector3d::UnitZ());
    end(Vector2d::Constant(cone.radius_mm), 0.0, 0.0, false);
    beginRound(cone.radius_mm / cone.length_mm, false);
    const Vector3d tip(0, 0, cone.length_mm);
    for (int i = 0; i < sides(); ++i) {
      const Vector2d r = Vector2d::Constant(cone.radius_mm);
      triangle(rim(r, i, 0), rim(r, i + 1, 0), tip);
    }
  }

 private:
  [[nodiscard]] int sides() const { return look_ == Look::kBeltHole ? 12 : 48; }

  [[nodiscard]] Vector3d rim(const Vector2d& radius_mm, int i, double z_mm) const {
    const double phi = 2.0 * std::numbers::pi * (i % sides()) / sides();
    return {radius_mm.x() * std::cos(phi), radius_mm.y() * std::sin(phi), z_mm};
  }

  void beginFlat(const Vector3d& normal_P) {
    mesh_.faces.push_back({.look = look_, .normal_W = X_WP_.linear() * normal_P, .X_WP = X_WP_});
  }

  void beginRound(double rise, bool inwards) {
    mesh_.faces.push_back(
        {.look = look_, .kind = Face::Kind::kRound, .X_WP = X_WP_, .rise = rise, .inwards = inwards});
  }

  void triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    mesh_.triangles.push_back({{X_WP_ * a, X_WP_ * b, X_WP_ * c}, static_cast<int>(mesh_.faces.size()) - 1});
  }

  void quad(const std::array<Vector3d, 4>& corners) {
    triangle(corners[0], corners[1], corners[2]);
    triangle(corners[0], corners[2], corners[3]);
  }

  // Wall from z.x() up to z.y(); seen from inside if it is that of a bore.
  void wall(const Vector2d& radius_mm, const Vector2d& z_mm, bool bore) {
    beginRound(0.0, bore);
    const Vector2d z = bore ? Vector2d(z_mm.reverse()) : z_mm;
    for (int i = 0; i < sides(); ++i) {
      quad({rim(radius_mm, i, z.x()), rim(radius_mm, i + 1, z.x()), rim(radius_mm, i + 1, z.y()),
            rim(radius_mm, i, z.y())});
    }
  }

  // A plate at z, with a hole of the share `bore` of its radius.
  void end(const Vector2d& radius_mm, double bore, double z_mm, bool upwards) {
    const int step = upwards ? 1 : -1;
    for (int i = 0; i < sides(); ++i) {
      const int a = upwards ? i : i + 1;
      const int b = a + step;
      if (bore > 0) {
        quad({rim(bore * radius_mm, a, z_mm), rim(radius_mm, a, z_mm), rim(radius_mm, b, z_mm),
              rim(bore * radius_mm, b, z_mm)});
      } else if (i > 0 && i + 1 < sides()) {
        triangle(rim(radius_mm, 0, z_mm), rim(radius_mm, a, z_mm), rim(radius_mm, b, z_mm));
      }
    }
  }

  Mesh& mesh_;
  Look look_;
  const Isometry3d& X_WP_;
};

}  // namespace

Vector3d Face::normalAt(const Vector3d& p_W_mm) const {
  if (kind == Kind::kFlat) return normal_W;
  const Vector3d p_P = X_WP.inverse(Eigen::Isometry) * p_W_mm;
  if (kind == Kind::kRoundedEdge) {
    const Vector3d out = p_P - p_P.cwiseMin(core_mm).cwiseMax(-core_mm);
    return out.squaredNorm() > 0 ? Vector3d(X_WP.linear() * out.normalized()) : normal_W;
  }
  const double across = std::hypot(p_P.x(), p_P.y());
  if (!(across > 0)) return X_WP.linear().col(2);
  const Vector3d out = Vector3d(p_P.x() / across, p_P.y() / across, rise).normalized();
  return X_WP.linear() * (inwards ? Vector3d(-out) : out);
}

Mesh meshOf(const twin::Scene& scene) {
  Mesh mesh;
  for (const twin::ScenePart& part : scene.parts) {
    std::visit(PartMesh(mesh, lookOf(part.material), part.X_WP), part.shape);
    const auto* const tube = std::get_if<twin::Cylinder>(&part.shape);
    if (part.material != Material::kTube || tube == nullptr) continue;
    PartMesh inside(mesh, scene.beam_on ? Look::kDischarge : Look::kBore, part.X_WP);
    inside(twin::Cylinder{0.45 * tube->radius_mm, 0.96 * tube->length_mm, 0.0});
  }
  return mesh;
}

}  // namespace kerfbench::scene
