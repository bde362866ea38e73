// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/svg_sheet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "firmware_under_test/planner/compensation/curves.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

std::string point(const Vector2d& p) { return fmt::format("{:.4f} {:.4f}", p.x() + 0.0, p.y() + 0.0); }

/// Draws an arc as two halves, so that a full circle has ends that differ.
std::string arcTo(const Segment& arc) {
  std::string text;
  const double r = arc.radiusMm();
  for (const double u : {0.5, 1.0}) {
    const bool large = 0.5 * std::abs(arc.sweep_rad) > std::numbers::pi;
    text += fmt::format(" A {:.4f} {:.4f} 0 {} {} {}", r, r, large ? 1 : 0, arc.sweep_rad > 0.0 ? 1 : 0,
                        point(arc.at(u * arc.lengthMm())));
  }
  return text;
}

}  // namespace

SvgSheet::SvgSheet(const Eigen::AlignedBox2d& box_mm, double px_per_mm) {
  const Vector2d size = box_mm.sizes();
  head_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" viewBox=\"{:.4f} {:.4f} "
      "{:.4f} {:.4f}\">\n<rect x=\"{:.4f}\" y=\"{:.4f}\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      size.x() * px_per_mm, size.y() * px_per_mm, box_mm.min().x(), -box_mm.max().y(), size.x(), size.y(),
      box_mm.min().x(), -box_mm.max().y());
}

void SvgSheet::path(const std::vector<Segment>& segments, const std::string& style) {
  if (segments.empty()) return;
  std::string d = "M " + point(segments.front().start_mm);
  for (const Segment& segment : segments) {
    d += segment.isArc() ? arcTo(segment) : " L " + point(segment.end_mm);
  }
  if ((segments.front().start_mm - segments.back().end_mm).norm() < 1e-4) d += " Z";
  shapes_ += fmt::format("<path d=\"{}\" style=\"fill:none;{}\"/>\n", d, style);
}

void SvgSheet::polyline(const std::vector<Vector2d>& points, const std::string& style) {
  std::string d;
  for (const Vector2d& p : points) d += (d.empty() ? "M " : " L ") + point(p);
  shapes_ += fmt::format("<path d=\"{}\" style=\"fill:none;{}\"/>\n", d, style);
}

void SvgSheet::ellipse(const Vector2d& centre_mm, double rx_mm, double ry_mm, const std::string& style) {
  shapes_ += fmt::format("<ellipse cx=\"{:.4f}\" cy=\"{:.4f}\" rx=\"{:.4f}\" ry=\"{:.4f}\" style=\"{}\"/>\n",
                         centre_mm.x(), centre_mm.y(), rx_mm, ry_mm, style);
}

void SvgSheet::text(const Vector2d& p_mm, double height_mm, const std::string& words) {
  words_ += fmt::format(
      "<text x=\"{:.4f}\" y=\"{:.4f}\" font-family=\"sans-serif\" font-size=\"{:.4f}\" "
      "style=\"paint-order:stroke;stroke:#fff;stroke-width:{:.4f}\">{}</text>\n",
      p_mm.x(), -p_mm.y(), height_mm, 0.25 * height_mm, words);
}

std::string SvgSheet::finish() const {
  return head_ + "<g transform=\"scale(1 -1)\">\n" + shapes_ + "</g>\n" + words_ + "</svg>\n";
}

std::string kerfPicture(const std::vector<std::vector<Segment>>& contours,
                        const std::vector<std::vector<Segment>>& paths, double radius_mm) {
  Eigen::AlignedBox2d box;
  for (const auto& all : {contours, paths}) {
    for (const auto& segments : all) {
      for (const Segment& segment : segments) box.extend(boxOf(segment));
    }
  }
  if (box.isEmpty()) box.extend(Vector2d::Zero());
  const double border = 2.0 * radius_mm + 0.02 * box.sizes().maxCoeff();
  box.extend(Vector2d(box.min().array() - border));
  box.extend(Vector2d(box.max().array() + border));
  const double extent = box.sizes().maxCoeff();
  SvgSheet sheet(box, 1000.0 / extent);
  for (const auto& path : paths) {
    sheet.path(path,
               fmt::format("stroke:#f4b183;stroke-width:{:.4f};stroke-linecap:round;stroke-linejoin:round",
                           2.0 * radius_mm));
  }
  const double fine = std::min(0.3 * radius_mm, 0.001 * extent);
  for (const auto& contour : contours)
    sheet.path(contour, fmt::format("stroke:#000;stroke-width:{:.5f}", fine));
  for (const auto& path : paths) sheet.path(path, fmt::format("stroke:#c00000;stroke-width:{:.5f}", fine));
  return sheet.finish();
}

}  // namespace kerfbench::planner
