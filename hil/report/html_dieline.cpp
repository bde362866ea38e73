// SPDX-License-Identifier: Apache-2.0
// The measured cut over the dieline, and the worst places in the camera's own pixels.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/drawing/drawing_picture.h"
#include "hil/inspect/evidence/places.h"
#include "hil/report/html_text.h"
#include "twin/base/image.h"

namespace kerfbench::report {
namespace {

constexpr double kExaggeration = 100.0;
constexpr std::size_t kMaxPoints = 8000;  ///< Over all panels; keeps the page small.
constexpr std::size_t kMaxPanels = 3;

bool isUsed(const dieline::Process process) { return process != dieline::Process::kIgnore; }

bool isShown(const vision::Caliper& c) { return c.found && !c.near_joint && std::isfinite(c.offset_mm); }

/// The units to show: those with the worst offsets or least coverage.
std::vector<int> unitsToShow(const RunReport& report) {
  std::map<int, double> badness;
  for (const inspect::EntityResult& e : report.result.entities) {
    const double offset = std::isfinite(e.worst_mm) ? std::abs(e.worst_mm) / report.limits.path_mm : 0.0;
    badness[e.unit] = std::max({badness[e.unit], offset, 10.0 * (1.0 - e.coverage)});
  }
  std::vector<std::pair<double, int>> order;
  for (const auto& [unit, value] : badness) order.emplace_back(-value, unit);
  std::sort(order.begin(), order.end());
  std::vector<int> units;
  for (std::size_t i = 0; i < std::min(order.size(), kMaxPanels); ++i) units.push_back(order[i].second);
  std::sort(units.begin(), units.end());
  return units;
}

/// Paths of one unit, as SVG path data.
struct Drawing {
  std::string nominal;
  std::string missing;
  std::array<std::string, kLimitBins> measured;
};

void lineTo(std::string& path, const Eigen::Vector2d& p, bool move) {
  fmt::format_to(std::back_inserter(path), "{}{:.2f} {:.2f}", move ? 'M' : 'L', p.x(), p.y());
}

void drawMeasured(const vision::EntityKerf& kerf, const dieline::Entity& entity, double limit_mm,
                  std::size_t stride, Drawing& drawing) {
  // The worst of each group of `stride` stations is kept: decimation must not hide it.
  std::optional<Eigen::Vector2d> last;
  std::size_t last_bin = kLimitBins;
  bool missing_open = false;
  for (std::size_t begin = 0; begin < kerf.calipers.size(); begin += stride) {
    const std::size_t end = std::min(begin + stride, kerf.calipers.size());
    const vision::Caliper* worst = nullptr;
    const vision::Caliper* lost = nullptr;
    for (std::size_t i = begin; i < end; ++i) {
      const vision::Caliper& c = kerf.calipers[i];
      // The bridges of a perforation are meant to be dark.
      if (!c.found && !c.near_joint && entity.process != dieline::Process::kPerforation) lost = &c;
      if (isShown(c) && (worst == nullptr || std::abs(c.offset_mm) > std::abs(worst->offset_mm))) worst = &c;
    }
    if (lost != nullptr) {
      lineTo(drawing.missing, lost->p_S_mm, !missing_open);
      if (!missing_open) drawing.missing += "h0.01";
    }
    missing_open = lost != nullptr;
    if (worst == nullptr) {
      last.reset();
      last_bin = kLimitBins;
      continue;
    }
    const Eigen::Vector2d t = dieline::tangentAt(entity.curve, worst->u);
    const Eigen::Vector2d p =
        worst->p_S_mm + kExaggeration * worst->offset_mm * Eigen::Vector2d(-t.y(), t.x());
    const std::size_t bin = limitBin(worst->offset_mm, limit_mm);
    if (last) {
      if (bin != last_bin) lineTo(drawing.measured[bin], *last, true);
      lineTo(drawing.measured[bin], p, false);
    } else {
      lineTo(drawing.measured[bin], p, true);
      drawing.measured[bin] += "h0.01";
    }
    last = p;
    last_bin = bin;
  }
}

std::string nominalPath(const RunReport& report, double size_mm) {
  std::string path;
  for (const dieline::Entity& entity : report.dieline->entities) {
    if (!isUsed(entity.process)) continue;
    bool first = true;
    const bool straight = std::holds_alternative<dieline::LineCurve>(entity.curve);
    for (const double u : dieline::stations(entity.curve, straight ? 1e6 : size_mm / 300.0)) {
      lineTo(path, dieline::pointAt(entity.curve, u), first);
      first = false;
    }
  }
  return path;
}

std::string panel(const RunReport& report, int unit, std::size_t stride, const std::string& nominal) {
  Drawing drawing;
  for (const vision::EntityKerf& kerf : report.kerf.entities) {
    const auto index = static_cast<std::size_t>(kerf.entity);
    if (kerf.unit != unit || index >= report.dieline->entities.size()) continue;
    drawMeasured(kerf, report.dieline->entities[index], report.limits.path_mm, stride, drawing);
  }
  Eigen::AlignedBox2d box = report.dieline->bounds();
  const double margin = std::max(0.05 * box.sizes().maxCoeff(), 2.0 * kExaggeration * report.limits.path_mm);
  const double x = box.min().x() - margin;
  const double y = -box.max().y() - margin;
  const double width = box.sizes().x() + 2.0 * margin;
  const double height = box.sizes().y() + 2.0 * margin;
  const double dot = 0.012 * std::max(width, height);
  std::string svg = fmt::format(
      "<figure><svg class=die viewBox='{:.2f} {:.2f} {:.2f} {:.2f}' role=img "
      "aria-label='Measured cut of unit {}'><g transform='scale(1 -1)'>",
      x, y, width, height, unit);
  svg += fmt::format("<path class=nominal d='{}'/>", nominal);
  if (!drawing.missing.empty()) svg += fmt::format("<path class=missing d='{}'/>", drawing.missing);
  for (std::size_t bin = 0; bin < kLimitBins; ++bin) {
    if (!drawing.measured[bin].empty())
      svg += fmt::format("<path class=b{} d='{}'/>", bin, drawing.measured[bin]);
  }
  std::string labels;
  for (const vision::StrayCut& stray : report.kerf.strays) {
    if (stray.unit != unit) continue;
    svg += fmt::format("<circle class=stray cx={:.2f} cy={:.2f} r={:.2f} />", stray.p_S_mm.x(),
                       stray.p_S_mm.y(), std::max(0.5 * dot, 0.5 * stray.extent_mm));
  }
  for (std::size_t i = 0; i < report.kerf.patches.size(); ++i) {
    const vision::KerfPatch& patch = report.kerf.patches[i];
    if (patch.unit != unit) continue;
    svg += fmt::format("<circle class=place cx={:.2f} cy={:.2f} r={:.2f} />", patch.p_S_mm.x(),
                       patch.p_S_mm.y(), dot);
    labels += fmt::format("<text class=placeno x={:.2f} y={:.2f} font-size={:.2f}>{}</text>",
                          patch.p_S_mm.x() + 1.2 * dot, -patch.p_S_mm.y() - 0.8 * dot, 2.4 * dot, i + 1);
  }
  svg += fmt::format("</g>{}</svg><figcaption>Unit {}</figcaption></figure>", labels, unit);
  return svg;
}

/// Polyline of an entity shifted along its left normal, clipped to the patch, in its pixels.
std::string patchLine(const vision::KerfPatch& patch, const dieline::Curve& curve, double shift_mm,
                      double reach_mm) {
  std::string path;
  bool inside_before = false;
  for (const double u : dieline::stations(curve, 0.05)) {
    const Eigen::Vector2d p = dieline::pointAt(curve, u);
    const bool inside = (p - patch.p_S_mm).norm() < reach_mm;
    if (inside) {
      const Eigen::Vector2d t = dieline::tangentAt(curve, u);
      lineTo(path, patch.pixel_from_S * Eigen::Vector2d(p + shift_mm * Eigen::Vector2d(-t.y(), t.x())),
             !inside_before);
    }
    inside_before = inside;
  }
  return path;
}

}  // namespace

std::string dielineFigures(const RunReport& report) {
  const std::vector<int> units = unitsToShow(report);
  if (units.empty() || report.dieline->bounds().isEmpty()) return {};
  std::size_t points = 0;
  for (const vision::EntityKerf& kerf : report.kerf.entities) {
    if (std::find(units.begin(), units.end(), kerf.unit) != units.end()) points += kerf.calipers.size();
  }
  const std::size_t stride = std::max<std::size_t>(1, (points + kMaxPoints - 1) / kMaxPoints);
  const std::string nominal = nominalPath(report, report.dieline->bounds().sizes().maxCoeff());
  std::string html = "<div class=legend><span class=key><i class=kn></i>dieline</span>";
  html += limitLegend(report.limits.path_mm);
  html +=
      "<span class=key><i class=km></i>no kerf found</span><span class=key><i class=ks></i>stray "
      "burn</span></div>";
  html += "<div class=panels>";
  for (const int unit : units) html += panel(report, unit, stride, nominal);
  html += fmt::format(
      "</div><p class=note>Deviations are drawn {:.0f} times enlarged, across the line. Numbered circles "
      "are the worst places, shown below.{}{}</p>",
      kExaggeration,
      stride > 1 ? fmt::format(" Of every {} stations the worst is drawn.", stride) : std::string(),
      static_cast<std::size_t>(report.print.units) > units.size()
          ? fmt::format(" {} of {} units are shown, the worst ones.", units.size(), report.print.units)
          : std::string());
  return html;
}

std::string worstPlaces(const RunReport& report) {
  std::string html;
  for (std::size_t i = 0; i < report.kerf.patches.size(); ++i) {
    const vision::KerfPatch& patch = report.kerf.patches[i];
    if (patch.image->width <= 0 || patch.image->height <= 0) continue;
    const double scale_px_mm = std::sqrt(std::abs(patch.pixel_from_S.linear().determinant()));
    if (!(scale_px_mm > 0.0)) continue;
    const double reach_mm = 0.75 * std::max(patch.image->width, patch.image->height) / scale_px_mm;
    std::string lines;
    for (const dieline::Entity& entity : report.dieline->entities) {
      if (!isUsed(entity.process) || dieline::nearestOn(entity.curve, patch.p_S_mm).distance_mm > reach_mm)
        continue;
      lines += fmt::format("<path class=pn d='{}'/>", patchLine(patch, entity.curve, 0.0, reach_mm));
      if (entity.id != patch.entity) continue;
      for (const double side : {-1.0, 1.0}) {
        lines += fmt::format("<path class=pt d='{}'/>",
                             patchLine(patch, entity.curve, side * report.limits.path_mm, reach_mm));
      }
    }
    const auto found =
        std::find_if(report.result.entities.begin(), report.result.entities.end(),
                     [&](const auto& e) { return e.unit == patch.unit && e.entity == patch.entity; });
    const std::string worst = found != report.result.entities.end() && std::isfinite(found->worst_mm)
                                  ? fmt::format(", {:+.1f} µm", 1e3 * found->worst_mm)
                                  : std::string();
    const int w = patch.image->width;
    const int h = patch.image->height;
    html += fmt::format(
        "<figure><svg class=patch viewBox='-0.5 -0.5 {} {}' role=img aria-label='Place {}'><image class=px "
        "x=-0.5 y=-0.5 "
        "width={} height={} href='{}'/>{}</svg><figcaption><b>{}</b> unit {}, E{}{}<br>{}"
        "</figcaption></figure>",
        w, h, i + 1, w, h, pngDataUri(*patch.image), lines, i + 1, patch.unit, patch.entity, worst,
        inspect::checks::placeOf(patch.p_S_mm));
  }
  if (html.empty()) return {};
  return "<div class=patches>" + html +
         fmt::format(
             "</div><p class=note>The camera's own pixels, back-lit: the kerf is bright. Solid: dieline. "
             "Dashed: "
             "±{:.3f} mm.</p>",
             report.limits.path_mm);
}

std::string drawingFigure(const RunReport& report) {
  const dieline::Dieline& dieline = *report.dieline;
  if (dieline.entities.empty()) return {};
  const drawing::PictureContent content = drawing::contentOf(
      dieline, std::filesystem::path(dieline.path).filename().string(), 1000, report.accepted);
  std::string svg = drawing::svgOf(dieline, content);
  // A file of its own has to name the format; within a page nothing may lead outside.
  constexpr std::string_view kFormat = " xmlns='http://www.w3.org/2000/svg'";
  svg.erase(svg.find(kFormat), kFormat.size());
  return fmt::format("<details><summary>{}</summary><figure>{}</figure></details>",
                     "Processes, size, pieces and holes, and what lint finds", svg);
}

}  // namespace kerfbench::report
