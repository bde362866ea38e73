// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/description/description.h"
#include "twin/description/machine_pose.h"
#include "twin/scene/scene.h"

namespace kerfbench::twin {

/// The numbers of a MachinePose one by one, but for its time.
enum class PoseColumn {
  kRoller,
  kBelt,
  kSlipX,
  kSlipY,
  kFrameX,
  kFrameY,
  kGantryX,
  kGantryY,
  kMirrorX,
  kMirrorY,
};
inline constexpr std::size_t kPoseColumns = 10;

/// Name with unit: "roller_mm", "mirror_x_rad", ….
std::string_view poseColumnName(PoseColumn column);
double poseColumnOf(const MachinePose& pose, PoseColumn column);
/// The columns that a machine of this kind moves, in their order.
std::vector<PoseColumn> poseColumnsOf(const MachineDescription& machine);

/// A joint that a column of the pose moves by q = scale * column.
struct SceneJoint {
  enum class Kind { kSlide, kTurn };
  Kind kind{};
  Eigen::Vector3d axis{Eigen::Vector3d::UnitX()};      ///< In W at rest; length 1. A turn is right-handed.
  Eigen::Vector3d origin_mm{Eigen::Vector3d::Zero()};  ///< A point of the axis of a turn, in W at rest.
  PoseColumn by{};
  double scale{1.0};
  double wrap_mm{0.0};  ///< > 0: q - wrap floor(q / wrap) instead of q, for what repeats.
};

/// Parts that move as one. At rest all columns of the pose are 0.
struct SceneBody {
  std::string name;
  int parent{-1};                  ///< Index of an earlier body; -1: it stands on the floor.
  std::vector<SceneJoint> joints;  ///< The last one acts first.
};

/// The ends of the belt, x in W.
struct BeltEnds {
  double min_x_mm{}, max_x_mm{};
};
/// What is seen of a part that the belt carries.
struct ShownOnBelt {
  enum class How {
    kAlways,
    kCut,          ///< Only what lies between the ends.
    kWholeWithin,  ///< All of it while a point of it lies between the ends, else nothing.
  };
  How how{How::kAlways};
  BeltEnds ends{};
  Eigen::Vector3d point_mm{Eigen::Vector3d::Zero()};  ///< The point, in W at rest.
};

/// A part at rest, and copies of it, `count` in all, each `step_mm` further on.
struct MovingPart {
  ScenePart part;
  int body{-1};  ///< -1: stands still.
  int count{1};
  Eigen::Vector3d step_mm{Eigen::Vector3d::Zero()};
  ShownOnBelt shown{};
};

/// A corner of the beam's path.
struct BeamCorner {
  enum class Kind {
    kRides,   ///< A point that rides on a body. If `direction` is not zero, the beam goes on along it.
    kMirror,  ///< The beam meets the plane z = 0 of a part's frame and is mirrored.
    kPlane,   ///< The beam meets a plane that stands in W, and goes on straight.
  };
  Kind kind{};
  int index{-1};                                       ///< Body that it rides on, or -1; or part.
  Eigen::Vector3d p_W_mm{Eigen::Vector3d::Zero()};     ///< At rest; a point of the plane.
  Eigen::Vector3d direction{Eigen::Vector3d::Zero()};  ///< Direction, or normal of the plane; length 1.
  double radius_mm{};                                  ///< 1/e² of the beam there, at rest.
};

/// A box in W at rest that moves with a body.
struct SceneBox {
  Eigen::AlignedBox3d box_mm;
  int body{-1};
  Eigen::Vector3d look{Eigen::Vector3d::Zero()};  ///< Direction of view, of length 1; zero: any.
};

/// A machine for somebody who moves it by himself: parts at rest, and the bodies that carry them. At every
/// pose it is the scene that sceneOf() builds, but for burnt paths and labels, to rounding; of a round part
/// the turn about its own axis is left open.
struct MovingScene {
  std::vector<SceneBody> bodies;
  std::vector<MovingPart> parts;
  /// From the tube to the last corner before the spot.
  std::vector<BeamCorner> beam;
  double spot_radius_mm{};  ///< 1/e² of the beam at height 0.
  SceneBox overall, head;

  /// Index of a body; -1 for an empty name. @throws std::logic_error if there is none.
  [[nodiscard]] int bodyNamed(std::string_view name) const;
  /// Index of the first part of a name. @throws std::logic_error if there is none.
  [[nodiscard]] int partNamed(std::string_view name) const;
};

/// Builds it: a pure function of its arguments. `content`: the extent of a unit; burnt paths are left out.
MovingScene movingScene(const MachineDescription& machine, const WebDescription& web,
                        const SceneContent& content = {});

/// Displacement of each body from rest.
std::vector<Eigen::Isometry3d> displacementsAt(const MovingScene& moving, const MachinePose& pose);
/// The parts as they are seen then, copies one by one.
std::vector<ScenePart> partsAt(const MovingScene& moving, const MachinePose& pose);
/// Corners of the beam before the spot.
std::vector<Eigen::Vector3d> beamAt(const MovingScene& moving, const MachinePose& pose);

}  // namespace kerfbench::twin
