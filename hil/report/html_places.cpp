// SPDX-License-Identifier: Apache-2.0
// The worst places in the camera's own pixels.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/places.h"
#include "hil/report/html_text.h"
#include "twin/base/image.h"

namespace kerfbench::report {
namespace {

/// Half of the picture's diagonal and some, on the sheet; 0 of a picture that shows nothing.
double reachOf_mm(const vision::KerfPatch& patch) {
  if (patch.image == nullptr || patch.image->width <= 0 || patch.image->height <= 0) return 0.0;
  const double scale_px_mm = std::sqrt(std::abs(patch.pixel_from_S.linear().determinant()));
  return scale_px_mm > 0.0 ? 0.75 * std::max(patch.image->width, patch.image->height) / scale_px_mm : 0.0;
}

/// Polyline of an entity shifted along its left normal, clipped to the patch, in its pixels.
std::string placeLine(const vision::KerfPatch& patch, const dieline::Curve& curve, double shift_mm,
                      double reach_mm) {
  std::string path;
  bool inside_before = false;
  for (const double u : dieline::stations(curve, 0.05)) {
    const Eigen::Vector2d p = dieline::pointAt(curve, u);
    const bool inside = (p - patch.p_S_mm).norm() < reach_mm;
    if (inside) {
      const Eigen::Vector2d t = dieline::tangentAt(curve, u);
      const Eigen::Vector2d at =
          patch.pixel_from_S * Eigen::Vector2d(p + shift_mm * Eigen::Vector2d(-t.y(), t.x()));
      fmt::format_to(std::back_inserter(path), "{}{:.2f} {:.2f}", inside_before ? 'L' : 'M', at.x(), at.y());
    }
    inside_before = inside;
  }
  return path;
}

}  // namespace

std::string placeFigure(const RunReport& report, std::size_t index, bool anchored) {
  const vision::KerfPatch& patch = report.kerf.patches[index];
  const double reach_mm = reachOf_mm(patch);
  if (!(reach_mm > 0.0)) return {};
  std::string lines;
  for (const dieline::Entity& entity : report.dieline->entities) {
    if (entity.process == dieline::Process::kIgnore ||
        dieline::nearestOn(entity.curve, patch.p_S_mm).distance_mm > reach_mm)
      continue;
    lines += fmt::format("<path class=pn d='{}'/>", placeLine(patch, entity.curve, 0.0, reach_mm));
    if (entity.id != patch.entity) continue;
    for (const double side : {-1.0, 1.0}) {
      lines += fmt::format("<path class=pt d='{}'/>",
                           placeLine(patch, entity.curve, side * report.limits.path_mm, reach_mm));
    }
  }
  const auto found = std::ranges::find_if(report.result.entities, [&](const inspect::EntityResult& e) {
    return e.unit == patch.unit && e.entity == patch.entity;
  });
  const std::string worst = found != report.result.entities.end() && std::isfinite(found->worst_mm)
                                ? fmt::format(", {:+.1f} µm", 1e3 * found->worst_mm)
                                : std::string();
  const std::string name = inspect::checks::nameOf(patch.unit, patch.entity);
  const int w = patch.image->width;
  const int h = patch.image->height;
  return fmt::format(
      "<figure{}><svg class=patch viewBox='-0.5 -0.5 {} {}' role=img aria-label='Place {}'><image class=px "
      "x=-0.5 y=-0.5 width={} height={} href='{}'/>{}</svg><figcaption><b>{}</b> {}{}<br>{}"
      "</figcaption></figure>",
      anchored ? fmt::format(" id='place-{}'", index + 1) : std::string(), w, h, index + 1, w, h,
      pngDataUri(*patch.image), lines, index + 1,
      hasEntityRow(report, patch.unit, patch.entity)
          ? fmt::format("<a href='#{}'>{}</a>", entityAnchor(patch.unit, patch.entity), name)
          : name,
      worst, inspect::checks::placeOf(patch.p_S_mm));
}

std::optional<std::size_t> placeNear(const RunReport& report, const inspect::Whereabouts& where) {
  if (!where.hasPlace()) return std::nullopt;
  std::optional<std::size_t> nearest;
  double least_mm = 0.0;
  for (std::size_t i = 0; i < report.kerf.patches.size(); ++i) {
    const vision::KerfPatch& patch = report.kerf.patches[i];
    if (patch.unit != where.unit) continue;
    const double away_mm = (patch.p_S_mm - Eigen::Vector2d(where.x_mm, where.y_mm)).norm();
    // Within the circle that fits into the picture.
    if (!(away_mm < reachOf_mm(patch) / 1.5) || (nearest && away_mm >= least_mm)) continue;
    nearest = i;
    least_mm = away_mm;
  }
  return nearest;
}

std::string worstPlaces(const RunReport& report) {
  std::string html;
  for (std::size_t i = 0; i < report.kerf.patches.size(); ++i) html += placeFigure(report, i, true);
  if (html.empty()) return {};
  return "<div class=patches>" + html +
         fmt::format(
             "</div><p class=note>The camera's own pixels, back-lit: the kerf is bright. Solid: dieline. "
             "Dashed: "
             "±{:.3f} mm.</p>",
             report.limits.path_mm);
}

std::string mosaicFigure(const RunReport& report) {
  const vision::KerfMosaic& mosaic = report.kerf.mosaic;
  if (mosaic.image == nullptr || mosaic.image->width <= 0 || mosaic.image->height <= 0) return {};
  const Eigen::Vector2d size_mm = mosaic.box_S_mm.sizes();
  const double x = mosaic.box_S_mm.min().x();
  const double y = -mosaic.box_S_mm.max().y();
  return fmt::format(
      "<input type=checkbox class=fold id=show-dieline checked><label for=show-dieline>the dieline over "
      "it</label><figure class=mosaic><svg class=mosaic viewBox='{0:.2f} {1:.2f} {2:.2f} {3:.2f}' role=img "
      "aria-label='All pictures of unit {4}'><image class=px x={0:.2f} y={1:.2f} width={2:.2f} "
      "height={3:.2f} "
      "preserveAspectRatio=none href='{5}'/><g class=overlay transform='scale(1 -1)'><use "
      "href='#dieline'/></g></svg><figcaption>Unit {4}, the worst, at true scale: all pictures of the kerf "
      "camera, "
      "back-lit. A pixel is {6:.2f} mm wide and as bright as the brightest of the camera's own that it "
      "stands "
      "for.</figcaption></figure>",
      x, y, size_mm.x(), size_mm.y(), mosaic.unit, pngDataUri(*mosaic.image),
      size_mm.x() / mosaic.image->width);
}

}  // namespace kerfbench::report
