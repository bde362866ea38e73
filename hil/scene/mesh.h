// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// Material of a face: those of the scene's parts, and what is seen inside the tube.
enum class Look {
  kSteel,
  kAluminium,
  kPaint,
  kDark,
  kBelt,
  kBeltHole,
  kBoard,
  kPrint,
  kMirror,
  kGlass,
  kTube,
  kAxisX,
  kAxisY,
  kAxisZ,
  kLight,
  kDischarge,  ///< The tube's gas while the laser is lit.
  kBore,       ///< The same while it is not.
};

/// A side of a part: all of its triangles have one look and one rule for the normal.
struct Face {
  enum class Kind {
    kFlat,
    kRoundedEdge,  ///< A side of a box whose edges are round; the box itself is drawn sharp.
    kRound,        ///< The wall of a cylinder or cone.
  };
  Look look{};
  Kind kind{};
  Eigen::Vector3d normal_W{Eigen::Vector3d::UnitZ()};  ///< kFlat, kRoundedEdge.
  Eigen::Isometry3d X_WP{Eigen::Isometry3d::Identity()};
  Eigen::Vector3d core_mm{
      Eigen::Vector3d::Zero()};  ///< kRoundedEdge: half of the box without its edges, in P.
  double rise{};                 ///< kRound: the normal's z for a length of 1 across, in P.
  bool inwards{};                ///< kRound: the wall of a bore.

  /// Outward normal at a point of the face, of length 1.
  [[nodiscard]] Eigen::Vector3d normalAt(const Eigen::Vector3d& p_W_mm) const;
};

struct Triangle {
  /// Counter-clockwise as seen from outside.
  std::array<Eigen::Vector3d, 3> corners_W_mm;
  int face{};  ///< Index in Mesh::faces.
};

struct Mesh {
  std::vector<Triangle> triangles;
  std::vector<Face> faces;
};

/// The parts of a scene as triangles: boxes with sharp edges, round parts with as many sides as a picture of
/// a thousand pixels needs.
Mesh meshOf(const twin::Scene& scene);

}  // namespace kerfbench::scene
