// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/fold_blank.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "hil/fold/fold_units.h"
#include "twin/base/random.h"

namespace kerfbench::fold {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMost_mm = 2000.0;
constexpr std::size_t kMostFaces = 16;
constexpr std::size_t kMostMarks = 64;
constexpr double kPitch_mm = 1e5;  // There is one unit.
constexpr std::uint64_t kPrintStream = 0x666f6c64ULL;

void readMarks(base::YamlReader& section, inspect::SpaceFace& face) {
  face.print.pitch_mm = kPitch_mm;
  const double diameter_mm = section.number("mark_diameter_mm", {.min = 0.5, .max = 20, .fallback = 3.0});
  const Vector2d half = Vector2d::Constant(0.5 * diameter_mm);
  for (base::YamlReader& mark : section.list("marks")) {
    const auto at = mark.numbers("at_mm", 2, {.min = -kMost_mm, .max = kMost_mm});
    const Vector2d p(at[0], at[1]);
    if (!face.outline_F_mm.contains(Eigen::AlignedBox2d(p - half, p + half)))
      mark.fault("at_mm", "the mark does not lie within the face");
    face.print.marks.push_back({p, diameter_mm});
  }
  if (face.print.marks.size() < 3 || face.print.marks.size() > kMostMarks)
    section.fault("marks", fmt::format("must list 3 … {} marks", kMostMarks));
}

/// The face that others are folded on.
Eigen::Isometry3d readPlace(base::YamlReader& section) {
  const Vector3d x = vectorOf(section.numbers("x_axis", 3, {.min = -1, .max = 1}));
  const Vector3d z = vectorOf(section.numbers("normal", 3, {.min = -1, .max = 1}));
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();
  X_WF.translation() = vectorOf(section.numbers("origin_mm", 3, {.min = -kMost_mm, .max = kMost_mm}));
  const bool square = x.norm() > 0.5 && z.norm() > 0.5 && std::abs(x.normalized().dot(z.normalized())) < 1e-6;
  if (!square) {
    section.fault("normal", "normal and x_axis must be directions at a right angle");
    return X_WF;
  }
  X_WF.linear() << x.normalized(), z.cross(x).normalized(), z.normalized();
  return X_WF;
}

/// Pose of a folded face in the one that it is folded on.
Eigen::Isometry3d foldedBy(const Vector2d& from, const Vector2d& to, double angle_rad) {
  const Vector2d along = (to - from).normalized();
  const Vector3d x(along.x(), along.y(), 0.0);
  const Vector3d flat(-along.y(), along.x(), 0.0);  // y of the face before it is folded.
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  const Vector3d y = std::cos(angle_rad) * flat - std::sin(angle_rad) * Vector3d::UnitZ();
  X.linear() << x, y, x.cross(y);
  X.translation() = Vector3d(from.x(), from.y(), 0.0);
  return X;
}

struct Placed {
  Eigen::Isometry3d drawn, standing;
  Eigen::AlignedBox2d outline;
};

Placed readFolded(base::YamlReader& section, const FoldBlank& blank) {
  Placed placed{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity(), {}};
  const std::string on = section.text("fold_on");
  const auto line = section.numbers("fold_mm", 4, {.min = -kMost_mm, .max = kMost_mm});
  const double angle_deg = section.number("fold_deg", {.min = -90, .max = 170});
  const double error_deg = section.number("fold_error_deg", {.min = -10, .max = 10, .fallback = 0.0});
  const double depth_mm = section.number("depth_mm", {.min = 1, .max = kMost_mm});
  const Vector2d from(line[0], line[1]);
  const Vector2d to(line[2], line[3]);
  if (!((to - from).norm() >= 1.0)) section.fault("fold_mm", "is shorter than 1 mm");
  const auto parent = std::ranges::find(blank.drawn, on, &inspect::SpaceFace::name);
  if (parent == blank.drawn.end()) {
    section.fault("fold_on", fmt::format("'{}' is the name of no face before this one", on));
    return placed;
  }
  const auto index = static_cast<std::size_t>(parent - blank.drawn.begin());
  placed.drawn = parent->X_WF * foldedBy(from, to, kDegree * angle_deg);
  placed.standing = blank.standing[index].X_WF * foldedBy(from, to, kDegree * (angle_deg + error_deg));
  placed.outline = Eigen::AlignedBox2d(Vector2d::Zero(), Vector2d((to - from).norm(), depth_mm));
  return placed;
}

}  // namespace

FoldBlank readBlank(base::YamlReader& file) {
  FoldBlank blank;
  std::vector<base::YamlReader> sections = file.list("faces");
  if (sections.empty() || sections.size() > kMostFaces)
    file.fault("faces", fmt::format("must list 1 … {} faces", kMostFaces));
  for (base::YamlReader& section : sections) {
    inspect::SpaceFace face;
    face.name = section.text("name");
    if (std::ranges::find(blank.drawn, face.name, &inspect::SpaceFace::name) != blank.drawn.end())
      section.fault("name", "is that of another face");
    Placed placed;
    if (blank.drawn.empty()) {
      placed.drawn = placed.standing = readPlace(section);
      const auto box = section.numbers("outline_mm", 4, {.min = -kMost_mm, .max = kMost_mm});
      placed.outline = Eigen::AlignedBox2d(Vector2d(box[0], box[1]), Vector2d(box[2], box[3]));
      if (placed.outline.isEmpty())
        section.fault("outline_mm", "must be least x, least y, largest x, largest y");
    } else {
      placed = readFolded(section, blank);
    }
    face.X_WF = placed.drawn;
    face.outline_F_mm = placed.outline;
    readMarks(section, face);
    blank.standing.push_back({placed.standing, placed.outline, face.print});
    blank.drawn.push_back(std::move(face));
  }
  return blank;
}

void misprint(double sigma_mm, std::uint64_t seed, FoldBlank& blank) {
  const CounterRandom random(seed, kPrintStream);
  std::uint64_t draw = 0;
  for (twin::BlankFace& face : blank.standing) {
    for (RegistrationMark& mark : face.print.marks) {
      const double x_mm = sigma_mm * random.normal(draw++);
      mark.p_SM_mm += Vector2d(x_mm, sigma_mm * random.normal(draw++));
    }
  }
}

}  // namespace kerfbench::fold
