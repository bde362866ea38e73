// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "twin/scene/scene.h"

namespace kerfbench::twin {

/// Names of what moves.
namespace body_name {
inline constexpr const char* kInfeed = "infeed roller";
inline constexpr const char* kOutfeed = "outfeed roller";
inline constexpr const char* kBeltHoles = "belt holes";
inline constexpr const char* kWeb = "web";
inline constexpr const char* kHead = "head";
inline constexpr const char* kXMirror = "x mirror";
inline constexpr const char* kYMirror = "y mirror";
inline constexpr const char* kBridge = "bridge";
inline constexpr const char* kBridgeMirror = "bridge mirror";
inline constexpr const char* kCarriage = "carriage";
}  // namespace body_name

/// Place of the conveyor; the rest of the machine is built around it.
struct ConveyorLayout {
  double min_x_mm{}, max_x_mm{};  ///< Axes of the two rollers.
  double half_width_mm{};         ///< Half the width of the belt, about y = 0.
  double belt_z_mm{};      ///< Height of the belt's upper face. The board lies on it and ends at z = 0.
  double frame_y_mm{};     ///< Outer face of the side frames, ±.
  double frame_top_mm{};   ///< Upper edge of the side frames, z.
  double eye_mark_y_mm{};  ///< Place y of the print mark sensor and of the eye marks.
};

/// Rows of holes in half of the belt's width; they are as far from each other along it.
inline constexpr double kHolesPerHalfWidth = 6.0;

/// Adds parts to a scene.
class SceneBuilder {
 public:
  explicit SceneBuilder(Scene& scene) : scene_(scene) {}

  /// Parts that are added from now on move with this body, one of body_name; empty: they stand still.
  void on(std::string body) { body_ = std::move(body); }

  void box(const std::string& name, Material material, const Eigen::Vector3d& min_mm,
           const Eigen::Vector3d& max_mm, double edge_radius_mm = 0.0);
  void cylinder(const std::string& name, Material material, const Eigen::Vector3d& from_mm,
                const Eigen::Vector3d& to_mm, double radius_mm, double bore_mm = 0.0);
  /// A plate whose front looks along `normal`; the first radius is along `along`, which is normal to it.
  struct PlacedDisc {
    Eigen::Vector3d centre_mm;
    Eigen::Vector3d normal;
    Eigen::Vector3d along;
    Eigen::Vector2d radius_mm;
    double thickness_mm;
  };
  void disc(const std::string& name, Material material, const PlacedDisc& disc);
  /// A shaft with a head along `direction`, of length 1.
  void arrow(const std::string& name, Material material, const Eigen::Vector3d& origin_mm,
             const Eigen::Vector3d& direction, double length_mm);

  Scene& scene() { return scene_; }

 private:
  void add(const std::string& name, Material material, const Eigen::Isometry3d& X_WP,
           const std::variant<Box, Cylinder, Disc, Cone>& shape) {
    scene_.parts.push_back({name, material, X_WP, shape, body_});
  }

  Scene& scene_;
  std::string body_;
};

/// A frame at `origin` with z along `z` and x as near to `along` as that allows; both are unit vectors.
Eigen::Isometry3d frameAlong(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& z,
                             const Eigen::Vector3d& along);

/// Lays out a conveyor long and wide enough for the machine's field and the board.
ConveyorLayout conveyorLayout(const MachineDescription& machine, const WebDescription& web,
                              const SceneContent& content);

// Adds parts of the machine; each function grows scene.overall and sets its own fields (beam, scene.head,
// scene.sheet).
void addConveyor(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
                 const ConveyorLayout& at);
void addBoard(SceneBuilder& build, const WebDescription& web, const SceneContent& content,
              const ConveyorLayout& at, const Eigen::Vector2d& p_WS_mm);
void addMirrorHead(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
                   const ConveyorLayout& layout);
void addGantry(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
               const ConveyorLayout& layout);

struct MovingScene;
// Add to a moving scene what no part of one scene tells: what repeats along the belt and is cut off at its
// ends, and the way of the beam.
void addWholeWeb(MovingScene& moving, const WebDescription& web, const SceneContent& content,
                 const ConveyorLayout& at);
void addMirrorBeam(MovingScene& moving, const MachineDescription& machine);
void addGantryBeam(MovingScene& moving, const MachineDescription& machine, const ConveyorLayout& layout);

/// 1/e² radius of the beam at a distance before its focus.
double beamRadius_mm(const BeamDescription& beam, double distance_mm);

}  // namespace kerfbench::twin
