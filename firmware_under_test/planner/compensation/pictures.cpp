// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/compensation/plane_check.h"
#include "firmware_under_test/planner/compensation/proof.h"
#include "firmware_under_test/planner/compensation/svg_sheet.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kPxPerMm = 55.0;

Eigen::AlignedBox2d window(double half_x, double half_y) {
  return {Vector2d(-half_x, -half_y), Vector2d(half_x, half_y)};
}

Picture planePicture(const std::string& pair, double first, double second, JointKind kind) {
  constexpr double kRadius = 0.6;
  // The beam runs on the left: a turn to the left is shortened.
  const double turn = kind == JointKind::kShortened ? 80.0 : kind == JointKind::kExtended ? -65.0 : -120.0;
  const Contour contour = healed(planeJoint(turn * kDeg, first, second, Side::kLeft), 1e-6);
  const Offset offset = offsetContours({contour}, kRadius);
  SvgSheet sheet(window(3.2, 3.2), kPxPerMm);
  for (const BeamPath& path : offset.paths) {
    sheet.path(path.segments,
               fmt::format("stroke:#f8d0b0;stroke-width:{};stroke-linejoin:round", 2.0 * kRadius));
  }
  sheet.path(contour.segments, "stroke:#000;stroke-width:0.07");
  for (const BeamPath& path : offset.paths) {
    sheet.path(path.segments, "stroke:#c00000;stroke-width:0.05");
    for (const Segment& segment : path.segments) {
      sheet.ellipse(segment.end_mm, 0.07, 0.07, "fill:#c00000");
    }
  }
  const std::string title = fmt::format("{}, {}", pair, nameOf(kind));
  sheet.text({-3.1, -3.0}, 0.32, title);
  return {fmt::format("plane-{}-{}", pair, nameOf(kind)), title, sheet.finish()};
}

/// View along the bisector of the two axes: both half planes are foreshortened alike, AB's above the fold.
class FoldView {
 public:
  explicit FoldView(double omega_rad) : shrink_(std::sin(0.5 * omega_rad)) {}
  [[nodiscard]] Vector2d first(const Vector2d& p) const { return {p.x(), shrink_ * p.y()}; }
  [[nodiscard]] Vector2d second(const Vector2d& p) const { return {p.x(), -shrink_ * p.y()}; }
  [[nodiscard]] double shrink() const { return shrink_; }

 private:
  double shrink_;
};

template <class Path>
std::vector<Vector2d> seen(const FoldView& view, const Path& path, const Vector2d& from, const Vector2d& to) {
  std::vector<Vector2d> points{view.first(from)};
  for (const Vector2d& p : path.first) points.push_back(view.first(p));
  points.emplace_back(path.fold_mm, 0.0);
  for (auto p = path.second.rbegin(); p != path.second.rend(); ++p) points.push_back(view.second(*p));
  points.push_back(view.second(to));
  return points;
}

Picture spacePicture(double alpha_deg, double beta_deg, double omega_deg) {
  const FoldCorner corner{alpha_deg * kDeg, beta_deg * kDeg, omega_deg * kDeg};
  const FoldView view(corner.omega_rad);
  SvgSheet sheet(window(4.0, 3.4), kPxPerMm);
  sheet.polyline({{-4, 0}, {4, 0}, {4, 3.4}, {-4, 3.4}}, "fill:#eef4fb");
  sheet.polyline({{-4, 0}, {4, 0}, {4, -3.4}, {-4, -3.4}}, "fill:#e3ebf4");
  sheet.polyline({{-4, 0}, {4, 0}}, "stroke:#777;stroke-width:0.03;stroke-dasharray:0.3 0.08 0.06 0.08");
  const auto leg = [](double angle) { return Vector2d(-std::cos(angle), std::sin(angle)); };
  const auto normal = [](double angle) { return Vector2d(std::sin(angle), std::cos(angle)); };
  constexpr double kFar = 9.0;
  const Vector2d a = leg(corner.alpha_rad);
  const Vector2d c = leg(corner.beta_rad);
  sheet.ellipse({0, 0}, 1.0, view.shrink(), "fill:none;stroke:#999;stroke-width:0.02");
  const Vector2d from = normal(corner.alpha_rad) + kFar * a;
  const Vector2d to = normal(corner.beta_rad) + kFar * c;
  sheet.polyline({view.first(kFar * a), {0, 0}, view.second(kFar * c)}, "stroke:#000;stroke-width:0.08");
  const PaperPath paper = paperPath(corner, 1.0);
  const FoldPath path = foldPath(corner, 1.0);
  if (paper.exists) {
    sheet.polyline(seen(view, paper, from, to), "stroke:#2e75b6;stroke-width:0.05;stroke-dasharray:0.12 0.1");
  }
  const std::vector<Vector2d> points = seen(view, path, from, to);
  sheet.polyline(points, "stroke:#c00000;stroke-width:0.05");
  for (std::size_t i = 1; i + 1 < points.size(); ++i) sheet.ellipse(points[i], 0.07, 0.07, "fill:#c00000");
  sheet.text(Vector2d(0.12, -0.32), 0.3, "B");
  sheet.text(view.first(2.6 * a) + Vector2d(-0.4, 0.1), 0.3, "A");
  sheet.text(view.second(2.6 * c) + Vector2d(-0.4, 0.0), 0.3, "C");
  sheet.text({-3.9, 0.1}, 0.25, "M");
  sheet.text({3.65, 0.1}, 0.25, "N");
  const std::string title = fmt::format("case {}, {}: α {:g}°, β {:g}°, Ω {:g}°", corner.number(),
                                        nameOf(corner.joint()), alpha_deg, beta_deg, omega_deg);
  sheet.text({-3.9, -3.25}, 0.28, title);
  return {fmt::format("space-case-{}", corner.number()), title, sheet.finish()};
}

}  // namespace

std::vector<Picture> planePictures() {
  std::vector<Picture> all;
  const std::array<std::pair<const char*, Vector2d>, 4> pairs{{{"line-line", {0.0, 0.0}},
                                                               {"line-arc", {0.0, -1.8}},
                                                               {"arc-line", {-1.8, 0.0}},
                                                               {"arc-arc", {1.8, -1.8}}}};
  for (const auto& [name, sweeps] : pairs) {
    for (const JointKind kind : {JointKind::kShortened, JointKind::kExtended, JointKind::kInserted}) {
      all.push_back(planePicture(name, sweeps.x(), sweeps.y(), kind));
    }
  }
  return all;
}

std::vector<Picture> spacePictures() {
  constexpr double kOmegaDeg = 240.0;
  std::vector<Picture> all;
  for (const auto& [alpha, beta] :
       {std::pair{35.0, 65.0}, std::pair{35.0, 110.0}, std::pair{60.0, 140.0}, std::pair{65.0, 35.0},
        std::pair{110.0, 35.0}, std::pair{140.0, 60.0}, std::pair{110.0, 145.0}, std::pair{145.0, 110.0}}) {
    all.push_back(spacePicture(alpha, beta, kOmegaDeg));
  }
  return all;
}

}  // namespace kerfbench::planner
