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

/// Look of a part.
enum class Material {
  kSteel,      ///< Turned steel: rollers, shafts.
  kAluminium,  ///< Aluminium profiles and plates.
  kPaint,      ///< Painted frame.
  kDark,       ///< Motors, sensors, rubber.
  kBelt,
  kBeltHole,
  kBoard,
  kPrint,
  kMirror,
  kGlass,  ///< Glass: windows and housings that are shown cut open.
  kTube,   ///< Glass of the laser; the discharge is seen in it.
  kAxisX,
  kAxisY,
  kAxisZ,
  kLight,  ///< The light half of a scale bar.
};

/// A box, centred at its frame's origin.
struct Box {
  Eigen::Vector3d size_mm{Eigen::Vector3d::Zero()};
  double edge_radius_mm{};  ///< 0: sharp edges; below half of the smallest side.
};
/// A cylinder about z of its frame, centred; a tube if it has a bore.
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
/// A cone about z of its frame: full radius at the origin, zero at z = length.
struct Cone {
  double radius_mm{};
  double length_mm{};
};

/// A rigid part of the machine, or of what lies on it.
struct ScenePart {
  std::string name;  ///< Name, e.g. "x mirror". Parts of one kind share a name ("belt hole").
  Material material{};
  Eigen::Isometry3d X_WP{Eigen::Isometry3d::Identity()};  ///< Pose of the part in W; lengths in mm.
  std::variant<Box, Cylinder, Disc, Cone> shape;
  std::string body{};  ///< What it moves with, see MovingScene; empty: stands still.
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
  /// Path of the beam from the laser over the mirrors to the board; empty: it misses the board.
  std::vector<BeamPoint> beam;
  bool beam_on{};  ///< True if the laser is lit; otherwise `beam` is the path that it would take.
  std::vector<std::vector<Eigen::Vector3d>> burnt;  ///< Polylines on the board's surface, W, mm.
  std::vector<SceneLabel> labels;                   ///< Labels of the whole: axes, scale bar.
  std::vector<SceneLabel> head_labels;              ///< Labels of the head.
  double floor_z_mm{};
  /// Extent of a picture of the whole, of the head and of the sheet.
  Eigen::AlignedBox3d overall, head, sheet;
  /// Direction in which to look at the head, to see the faces of its mirrors; length 1.
  Eigen::Vector3d head_view{Eigen::Vector3d::UnitY()};
};

/// Content of a scene besides the machine itself.
struct SceneContent {
  bool beam_on{};
  /// Paths burnt so far, in S of unit 0: they move with the sheet.
  std::vector<std::vector<Eigen::Vector2d>> burnt_S_mm;
  /// Extent of a unit of the sheet besides its printed marks, in its S; empty: none.
  Eigen::AlignedBox2d unit_S_mm;
};

/// Builds the scene: a pure function of its arguments. The sheet lies at web.start_x_mm + belt travel + slip;
/// board beyond the ends of the belt is left out.
Scene sceneOf(const MachineDescription& machine, const WebDescription& web, const MachinePose& pose,
              const SceneContent& content = {});

}  // namespace kerfbench::twin
