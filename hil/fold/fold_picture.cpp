// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "hil/base/text.h"
#include "hil/fold/fold_report.h"
#include "hil/report/html_text.h"

namespace kerfbench::fold {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWidth_px = 900.0;
constexpr double kMargin_px = 20.0;

/// Parallel projection along the mean of the faces' normals, W's z upright.
class Projection {
 public:
  explicit Projection(const std::vector<inspect::SpaceFace>& faces) {
    Vector3d towards = Vector3d(0.05, -0.1, 0.15);
    for (const inspect::SpaceFace& face : faces) towards += face.X_WF.linear().col(2);
    towards.normalize();
    right_ = Vector3d::UnitZ().cross(towards);
    right_ = right_.norm() > 1e-3 ? Vector3d(right_.normalized()) : Vector3d(Vector3d::UnitX());
    down_ = right_.cross(towards);
    for (const inspect::SpaceFace& face : faces) {
      for (const Vector3d& corner : cornersOf(face)) box_.extend(flat(corner));
    }
    scale_ = (kWidth_px - 2.0 * kMargin_px) / std::max(box_.sizes().x(), 1.0);
  }
  static std::vector<Vector3d> cornersOf(const inspect::SpaceFace& face) {
    const Vector2d& a = face.outline_F_mm.min();
    const Vector2d& b = face.outline_F_mm.max();
    std::vector<Vector3d> corners;
    for (const Vector2d& p : {a, Vector2d(b.x(), a.y()), b, Vector2d(a.x(), b.y())})
      corners.emplace_back(face.X_WF * Vector3d(p.x(), p.y(), 0.0));
    return corners;
  }
  [[nodiscard]] Vector2d at(const Vector3d& p_W_mm) const {
    return scale_ * (flat(p_W_mm) - box_.min()) + Vector2d::Constant(kMargin_px);
  }
  [[nodiscard]] double height_px() const { return scale_ * box_.sizes().y() + 2.0 * kMargin_px; }

 private:
  [[nodiscard]] Vector2d flat(const Vector3d& p) const { return {right_.dot(p), down_.dot(p)}; }
  Vector3d right_, down_;
  Eigen::AlignedBox2d box_;
  double scale_{1.0};
};

std::string pointsOf(const std::vector<Vector2d>& points) {
  std::string text;
  for (const Vector2d& p : points) text += fmt::format("{:.1f},{:.1f} ", p.x(), p.y());
  return text;
}

std::string blankOf(const inspect::SpaceJob& job, const Projection& projection) {
  std::string svg;
  for (const inspect::SpaceFace& face : job.faces) {
    std::vector<Vector2d> corners;
    for (const Vector3d& corner : Projection::cornersOf(face)) corners.push_back(projection.at(corner));
    const Vector2d middle = 0.5 * (corners[0] + corners[2]);
    svg += fmt::format(
        R"(<polygon points="{}" fill="#e8e0d0" fill-opacity="0.6" stroke="#987"/><text x="{:.0f}" y="{:.0f}" fill="#987">{}</text>)",
        pointsOf(corners), middle.x(), middle.y(), base::escapeHtml(face.name));
    for (const RegistrationMark& mark : face.print.marks) {
      const Vector2d p = projection.at(face.X_WF * Vector3d(mark.p_SM_mm.x(), mark.p_SM_mm.y(), 0.0));
      svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="#555"/>)", p.x(), p.y());
    }
  }
  return svg;
}

constexpr std::array<const char*, report::kLimitBins> kColours{"#1a7f37", "#1a7f37", "#7a8f17", "#c77700",
                                                               "#c01818"};

}  // namespace

std::string foldPicture(const FoldReport& report, double times) {
  const inspect::SpaceJob& job = report.scenario.job;
  const Projection projection(job.faces);
  std::string svg = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:.0f} {:.0f}" role="img" aria-label="The folded blank with contour and measured edge">)",
      kWidth_px, projection.height_px());
  svg += blankOf(job, projection);
  std::vector<Vector2d> contour;
  for (const inspect::ContourPoint& point : report.scenario.contour)
    contour.push_back(projection.at(point.p_W_mm));
  svg +=
      fmt::format(R"(<polyline points="{}" fill="none" stroke="#246" stroke-width="1"/>)", pointsOf(contour));
  for (const inspect::EdgeReading& reading : report.judgement.result.readings) {
    if (!reading.found) continue;
    const std::size_t point = job.lines[reading.line].point;
    const Vector3d from = report.scenario.contour[point].p_W_mm;
    const Vector3d along = (report.scenario.contour[point + 1].p_W_mm - from).normalized();
    const Vector3d foot = from + along.dot(reading.edge_W_mm - from) * along;
    const Vector2d p = projection.at(foot + times * (reading.edge_W_mm - foot));
    const bool judged = reading.zone == inspect::EdgeZone::kAlong;
    const std::size_t bin = report::limitBin(
        judged ? reading.distance_mm() : std::min(0.0, reading.beside_mm), report.scenario.limits.path_mm);
    svg +=
        fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="1.6" fill="{}"/>)", p.x(), p.y(), kColours.at(bin));
  }
  return svg + "</svg>";
}

}  // namespace kerfbench::fold
