// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/dieline/process.h"

namespace kerfbench::dieline {

/// Exact curves of a dieline, in mm in the sheet frame S. Each has a parameter u in [0, 1] from start to end.

struct LineCurve {
  Eigen::Vector2d start_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d end_mm{Eigen::Vector2d::Zero()};
};

/// Circular arc. sweep_rad > 0 is counter-clockwise; |sweep_rad| = 2 pi is a full circle.
struct ArcCurve {
  Eigen::Vector2d centre_mm{Eigen::Vector2d::Zero()};
  double radius_mm{};        ///< > 0
  double start_angle_rad{};  ///< Angle from +x, counter-clockwise.
  double sweep_rad{};
};

/// Elliptic arc: centre + major cos t + minor sin t, t = start + u * sweep. Also a sheared circle.
struct EllipseCurve {
  Eigen::Vector2d centre_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d major_mm{Eigen::Vector2d::UnitX()};
  Eigen::Vector2d minor_mm{Eigen::Vector2d::UnitY()};
  double start_rad{};
  double sweep_rad{};
};

/// Rational cubic Bézier; weights of 1 make it a plain one.
struct BezierCurve {
  Eigen::Matrix<double, 2, 4> control_mm{Eigen::Matrix<double, 2, 4>::Zero()};
  Eigen::Vector4d weight{Eigen::Vector4d::Ones()};  ///< All > 0.
};

using Curve = std::variant<LineCurve, ArcCurve, EllipseCurve, BezierCurve>;

Eigen::Vector2d pointAt(const Curve& curve, double u);
/// d(point)/du, mm.
Eigen::Vector2d derivativeAt(const Curve& curve, double u);
/// Unit tangent in the sense of increasing u; the chord's direction where the derivative vanishes.
Eigen::Vector2d tangentAt(const Curve& curve, double u);
/// Signed curvature 1/mm, positive turning left; 0 where the derivative vanishes.
double curvatureAt(const Curve& curve, double u);
/// Arc length, mm, to 1e-9 relative.
double lengthOf(const Curve& curve);
Curve reversed(const Curve& curve);
/// The affine image; a circular arc stays one under similarities and becomes an EllipseCurve else.
Curve transformed(const Curve& curve, const Eigen::Affine2d& X);
/// True when both ends agree to 1e-6 mm (full circles and ellipses, closed Béziers).
bool isClosed(const Curve& curve);

/// The nearest point of the curve to a given one.
struct Nearest {
  double u{};
  double distance_mm{};
};
Nearest nearestOn(const Curve& curve, const Eigen::Vector2d& p_mm);

/// Parameters at arc-length stations no more than `pitch_mm` apart, both ends included (>= 2 values).
std::vector<double> stations(const Curve& curve, double pitch_mm);

/// One curve of the drawing with what it is for and where it came from.
struct Entity {
  int id{};  ///< Index in Dieline::entities; the name of the entity in reports is "E<id>".
  Curve curve;
  Process process{Process::kCut};
  std::string layer;   ///< DXF layer, or the SVG stroke colour as #rrggbb.
  std::string origin;  ///< Place in the file, e.g. "line 204: LWPOLYLINE" .
  /// What it was drawn for, if a selection leaves it out: its process is kIgnore then. Empty for all others,
  /// those that a rule of the layers ignores among them.
  std::optional<Process> left_out{};
};

/// Tells what the entity was drawn for, whether it is selected or not. Inside and outside follow from this: a
/// hole that is cut alone is still a hole.
inline Process drawnFor(const Entity& entity) { return entity.left_out.value_or(entity.process); }

/// How long one unit was taken to be, where the file itself does not say it.
struct UnsaidUnit {
  int line{};            ///< Line at which the file would say it; 0: nowhere.
  double taken_mm{1.0};  ///< As it was told, or what is usual.
};

struct Dieline {
  std::string path;
  std::vector<Entity> entities;
  /// What the file holds besides and what was mended, one sentence for each kind: "TEXT: 3 are ignored, …".
  std::vector<std::string> notes{};
  std::optional<UnsaidUnit> unsaid_unit{};

  /// Box around all entities that are not kIgnore; exact to 1e-6 mm. Empty box if there is none.
  [[nodiscard]] Eigen::AlignedBox2d bounds() const;
};

}  // namespace kerfbench::dieline
