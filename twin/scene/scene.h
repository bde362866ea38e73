// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/description/description.h"
#include "twin/description/machine_pose.h"

namespace kerfbench::twin {

/// What a part looks like.
enum class Material {
  kSteel,      ///< Turned: rollers, shafts.
  kAluminium,  ///< Profiles and plates.
  kPaint,      ///< Painted frame.
  kDark,       ///< Motors, sensors, rubber.
  kBelt,
  kBeltHole,
  kBoard,
  kPrint,
  kMirror,
  kGlass,  ///< Windows and housings that are shown cut open.
  kTube,   ///< Glass of the laser; the discharge is seen in it.
  kAxisX,
  kAxisY,
  kAxisZ,
  kLight,  ///< The light half of a scale bar.
};

/// Centred at its frame's origin.
struct Box {
  Eigen::Vector3d size_mm{Eigen::Vector3d::Zero()};
  double edge_radius_mm{};  ///< 0: sharp edges; below half of the smallest side.
};
/// About z of its frame, centred; a tube if it has a bore.
struct Cylinder {
  double radius_mm{};
  double length_mm{};
  double bore_mm{};  ///< Radius of the bore; 0: solid.
};
/// An elliptic plate. Its front lies in z = 0 of its frame and looks along +z.
struct Disc {
  Eigen::Vector2d radius_mm{Eigen::Vector2d::Zero()};
  double thickness_mm{};
};
/// About z of its frame: radius at the origin, none at z = length.
struct Cone {
  double radius_mm{};
  double length_mm{};
};

/// A rigid part of the machine, or of what lies on it.
struct ScenePart {
  std::string name;  ///< E.g. "x mirror". Parts of one kind share a name ("belt hole").
  Material material{};
  Eigen::Isometry3d X_WP{Eigen::Isometry3d::Identity()};  ///< Lengths in mm.
  std::variant<Box, Cylinder, Disc, Cone> shape;
};

struct BeamPoint {
  Eigen::Vector3d p_W_mm{Eigen::Vector3d::Zero()};
  double radius_mm{};  ///< 1/e²
};

struct SceneLabel {
  std::string text;
  Eigen::Vector3d p_W_mm{Eigen::Vector3d::Zero()};
};

/// The machine at one moment as bodies in W. Dimensions that the description does not give (frame, housings,
/// length of the belt) are chosen to fit those that it gives, and have no part in the model.
struct Scene {
  std::string machine;
  double time_s{};
  std::vector<ScenePart> parts;
  std::vector<BeamPoint> beam;  ///< From the laser by way of the mirrors to the board; empty: it misses.
  bool beam_on{};               ///< Else `beam` is where it would go.
  std::vector<std::vector<Eigen::Vector3d>> burnt;  ///< Polylines on the board's surface, W, mm.
  std::vector<SceneLabel> labels;                   ///< Labels of the whole: axes, scale bar.
  std::vector<SceneLabel> head_labels;              ///< Labels of the head.
  double floor_z_mm{};
  Eigen::AlignedBox3d overall, head,
      sheet;  ///< What a picture of the whole, of the head, of the sheet holds.
  /// Along which way to look at the head, to see the faces of its mirrors; length 1.
  Eigen::Vector3d head_view{Eigen::Vector3d::UnitY()};
};

/// What a scene shows beside the machine itself.
struct SceneContent {
  bool beam_on{};
  /// Paths burnt so far, in S of unit 0: they move with the sheet.
  std::vector<std::vector<Eigen::Vector2d>> burnt_S_mm;
  /// What a unit of the sheet holds beside its printed marks, in its S; empty: nothing.
  Eigen::AlignedBox2d unit_S_mm;
};

/// Pure function of its arguments. The sheet lies at web.start_x_mm + belt travel + slip; board beyond the
/// ends of the belt is left out.
Scene sceneOf(const MachineDescription& machine, const WebDescription& web, const MachinePose& pose,
              const SceneContent& content = {});

}  // namespace kerfbench::twin
