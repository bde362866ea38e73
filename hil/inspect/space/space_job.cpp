// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/space/space_job.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::inspect {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNormal_rad = 0.5 * std::numbers::pi / 180.0;
constexpr double kOnFace_mm = 0.05;
constexpr double kBeyond = 3.0;  // Radii that an offset goes on beyond its line, at most.

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool holds(const SpaceFace& face, const Vector3d& p_W_mm) {
  const Vector3d p_F_mm = face.X_WF.inverse() * p_W_mm;
  return std::abs(p_F_mm.z()) <= kOnFace_mm &&
         face.outline_F_mm.exteriorDistance(Vector2d(p_F_mm.head<2>())) <= kOnFace_mm;
}

std::optional<std::size_t> faceOf(const std::vector<SpaceFace>& faces, const ContourPoint& from,
                                  const ContourPoint& to) {
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double cosine = faces[i].X_WF.linear().col(2).dot(from.axis_W);
    if (cosine > std::cos(kNormal_rad) && holds(faces[i], from.p_W_mm) && holds(faces[i], to.p_W_mm))
      return i;
  }
  return std::nullopt;
}

/// Way that a line's offset loses at a corner by the turn towards the kerf; < 0 where it is extended.
double lostAtCorner(const SpaceLine& in, const SpaceLine& out, double side, double radius_mm) {
  const double turn_rad = side * std::atan2(cross(in.along_F, out.along_F), in.along_F.dot(out.along_F));
  return std::max(-kBeyond * radius_mm, radius_mm * std::tan(0.5 * turn_rad));
}

/// Part of a line's offset that lies within the face.
std::pair<double, double> withinFace(const SpaceLine& line, const Eigen::AlignedBox2d& outline,
                                     double radius_mm) {
  double least = -kBeyond * radius_mm;
  double most = line.length_mm + kBeyond * radius_mm;
  const Vector2d from = line.from_F_mm + radius_mm * line.beside_F;
  for (Eigen::Index i = 0; i < 2; ++i) {
    if (std::abs(line.along_F[i]) < 1e-9) continue;
    const double a = (outline.min()[i] - from[i]) / line.along_F[i];
    const double b = (outline.max()[i] - from[i]) / line.along_F[i];
    least = std::max(least, std::min(a, b));
    most = std::min(most, std::max(a, b));
  }
  return {least, most};
}

void layOffsets(SpaceJob& job) {
  for (std::size_t i = 0; i < job.lines.size(); ++i) {
    SpaceLine& line = job.lines[i];
    const auto [least, most] = withinFace(line, job.faces[line.face].outline_F_mm, job.kerf_radius_mm);
    line.kerf_from_mm = 0.0;
    line.kerf_to_mm = line.length_mm;
    if (line.begin == LineEndKind::kFold) line.kerf_from_mm = least;
    if (line.end == LineEndKind::kFold) line.kerf_to_mm = most;
    if (line.begin == LineEndKind::kCorner)
      line.kerf_from_mm = lostAtCorner(job.lines[i - 1], line, job.side, job.kerf_radius_mm);
    if (line.end == LineEndKind::kCorner)
      line.kerf_to_mm -= lostAtCorner(line, job.lines[i + 1], job.side, job.kerf_radius_mm);
  }
}

/// Draws parts of offsets.
class DrawingMaker {
 public:
  DrawingMaker(const SpaceJob& job, std::size_t face) : job_(job) { dieline_.path = job.faces[face].name; }
  void add(std::size_t index, double from_mm, double to_mm) {
    const SpaceLine& line = job_.lines[index];
    const Vector2d start = line.from_F_mm + job_.kerf_radius_mm * line.beside_F;
    dieline::Entity entity;
    entity.id = static_cast<int>(lines_.size());
    entity.curve = dieline::LineCurve{start + from_mm * line.along_F, start + to_mm * line.along_F};
    entity.layer = dieline_.path;
    dieline_.entities.push_back(std::move(entity));
    lines_.push_back(index);
    from_mm_.push_back(from_mm);
  }
  [[nodiscard]] FaceDrawing drawing() const {
    return {std::make_shared<const dieline::Dieline>(dieline_), lines_, from_mm_};
  }

 private:
  const SpaceJob& job_;
  dieline::Dieline dieline_;
  std::vector<std::size_t> lines_;
  std::vector<double> from_mm_;
};

}  // namespace

SpaceJob layContour(const std::vector<ContourPoint>& contour, std::vector<SpaceFace> faces, double side,
                    double kerf_radius_mm, const std::string& name) {
  SpaceJob job;
  job.faces = std::move(faces);
  job.side = side;
  job.kerf_radius_mm = kerf_radius_mm;
  std::string faults;
  for (std::size_t i = 0; i + 1 < contour.size(); ++i) {
    const auto face = faceOf(job.faces, contour[i], contour[i + 1]);
    if (!face) {
      faults += fmt::format("{}{}:{}: the line that begins here lies in no face of the blank",
                            faults.empty() ? "" : "\n", name, contour[i].file_line);
      continue;
    }
    const Eigen::Isometry3d X_FW = job.faces[*face].X_WF.inverse();
    SpaceLine line;
    line.face = *face;
    line.point = i;
    line.from_F_mm = (X_FW * contour[i].p_W_mm).head<2>();
    line.to_F_mm = (X_FW * contour[i + 1].p_W_mm).head<2>();
    line.length_mm = (line.to_F_mm - line.from_F_mm).norm();
    line.along_F = (line.to_F_mm - line.from_F_mm) / line.length_mm;
    line.beside_F = side * Vector2d(-line.along_F.y(), line.along_F.x());
    if (!job.lines.empty()) {
      line.begin = job.lines.back().face == *face ? LineEndKind::kCorner : LineEndKind::kFold;
      job.lines.back().end = line.begin;
    }
    job.lines.push_back(line);
  }
  if (!faults.empty()) throw base::InputError(faults);
  layOffsets(job);
  for (const SpaceLine& line : job.lines) {
    if (line.kerf_to_mm - line.kerf_from_mm >= 2.0 * kerf_radius_mm) continue;
    faults += fmt::format("{}{}:{}: the line that begins here is too short for its kerf",
                          faults.empty() ? "" : "\n", name, contour[line.point].file_line);
  }
  if (!faults.empty()) throw base::InputError(faults);
  return job;
}

FacePlan planFace(const SpaceJob& job, std::size_t face) {
  constexpr double kLeast_mm = 0.05;  // Shortest part beyond a fold that is looked at.
  DrawingMaker kerfs(job, face);
  DrawingMaker beyond(job, face);
  for (std::size_t i = 0; i < job.lines.size(); ++i) {
    const SpaceLine& line = job.lines[i];
    if (line.face != face) continue;
    kerfs.add(i, line.kerf_from_mm, line.kerf_to_mm);
    if (line.begin == LineEndKind::kFold && line.kerf_from_mm > kLeast_mm)
      beyond.add(i, 0.0, line.kerf_from_mm);
    if (line.end == LineEndKind::kFold && line.length_mm - line.kerf_to_mm > kLeast_mm)
      beyond.add(i, line.kerf_to_mm, line.length_mm);
  }
  return {kerfs.drawing(), beyond.drawing()};
}

}  // namespace kerfbench::inspect
