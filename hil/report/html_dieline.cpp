// SPDX-License-Identifier: Apache-2.0
// The measured cut over the dieline, enlarged by the size of the error and at true scale.
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
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

/// The largest deviation is drawn as long as this share of the drawing at most, and no more than so many
/// times enlarged.
constexpr double kLargestShare = 0.03;
constexpr double kMostExaggerated = 100.0;
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

/// Paths of one entity, as SVG path data.
struct Drawing {
  std::string missing;
  std::array<std::string, kLimitBins> measured;
};

void lineTo(std::string& path, const Eigen::Vector2d& p, bool move) {
  fmt::format_to(std::back_inserter(path), "{}{:.2f} {:.2f}", move ? 'M' : 'L', p.x(), p.y());
}

/// Deviations are drawn `enlarged` times, across the line.
Drawing drawMeasured(const vision::EntityKerf& kerf, const dieline::Entity& entity, double limit_mm,
                     std::size_t stride, double enlarged) {
  Drawing drawing;
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
    const Eigen::Vector2d p = worst->p_S_mm + enlarged * worst->offset_mm * Eigen::Vector2d(-t.y(), t.x());
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
  return drawing;
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

/// What is drawn of an entity of a unit, as a link to its row.
std::string linkedEntity(const RunReport& report, const vision::EntityKerf& kerf, const Drawing& drawing) {
  std::string paths;
  if (!drawing.missing.empty()) paths += fmt::format("<path class=missing d='{}'/>", drawing.missing);
  for (std::size_t bin = 0; bin < kLimitBins; ++bin)
    if (!drawing.measured[bin].empty())
      paths += fmt::format("<path class=b{} d='{}'/>", bin, drawing.measured[bin]);
  if (paths.empty()) return {};
  const std::string title = fmt::format("<title>unit {}, E{}</title>", kerf.unit, kerf.entity);
  return hasEntityRow(report, kerf.unit, kerf.entity)
             ? fmt::format("<a href='#{}'>{}{}</a>", entityAnchor(kerf.unit, kerf.entity), title, paths)
             : "<g>" + title + paths + "</g>";
}

/// The measured cut of a unit.
std::string measuredLayer(const RunReport& report, int unit, std::size_t stride, double enlarged) {
  std::string svg;
  for (const vision::EntityKerf& kerf : report.kerf.entities) {
    const auto index = static_cast<std::size_t>(kerf.entity);
    if (kerf.unit != unit || index >= report.dieline->entities.size()) continue;
    svg += linkedEntity(
        report, kerf,
        drawMeasured(kerf, report.dieline->entities[index], report.limits.path_mm, stride, enlarged));
  }
  return svg;
}

/// Stray burns, and the places of the pictures with their numbers. A dot is so large.
struct Marks {
  std::string upright;  ///< In a frame whose y points up.
  std::string labels;   ///< In that of the figure.
};
Marks marksOf(const RunReport& report, int unit, double dot) {
  Marks marks;
  for (const vision::StrayCut& stray : report.kerf.strays) {
    if (stray.unit != unit) continue;
    marks.upright += fmt::format("<circle class=stray cx={:.2f} cy={:.2f} r={:.2f} />", stray.p_S_mm.x(),
                                 stray.p_S_mm.y(), std::clamp(0.5 * stray.extent_mm, 0.5 * dot, 2.0 * dot));
  }
  for (std::size_t i = 0; i < report.kerf.patches.size(); ++i) {
    const vision::KerfPatch& patch = report.kerf.patches[i];
    if (patch.unit != unit) continue;
    marks.upright += fmt::format("<circle class=place cx={:.2f} cy={:.2f} r={:.2f} />", patch.p_S_mm.x(),
                                 patch.p_S_mm.y(), dot);
    marks.labels += fmt::format(
        "<a href='#place-{0}'><text class=placeno x={1:.2f} y={2:.2f} font-size={3:.2f}>{0}</text></a>",
        i + 1, patch.p_S_mm.x() + 1.2 * dot, -patch.p_S_mm.y() - 0.8 * dot, 2.4 * dot);
  }
  return marks;
}

/// The view of a figure of the whole drawing, with a margin on each side.
struct View {
  double x{}, y{}, width{}, height{};
  [[nodiscard]] std::string box() const {
    return fmt::format("{:.2f} {:.2f} {:.2f} {:.2f}", x, y, width, height);
  }
  [[nodiscard]] double dot() const { return 0.012 * std::max(width, height); }
};
View viewOf(const dieline::Dieline& dieline, double least_margin_mm) {
  const Eigen::AlignedBox2d box = dieline.bounds();
  const double margin = std::max(0.05 * box.sizes().maxCoeff(), least_margin_mm);
  return {box.min().x() - margin, -box.max().y() - margin, box.sizes().x() + 2.0 * margin,
          box.sizes().y() + 2.0 * margin};
}

std::string panel(const RunReport& report, int unit, std::size_t stride, double enlarged) {
  const View view = viewOf(*report.dieline, 1.5 * enlarged * report.limits.path_mm);
  const Marks marks = marksOf(report, unit, view.dot());
  std::string svg = fmt::format(
      "<figure id='unit-{}'><svg class=die viewBox='{}' role=img aria-label='Measured cut of unit {}'><g "
      "transform='scale(1 -1)'><use href='#dieline'/>",
      unit, view.box(), unit);
  svg += "<g class=enlarged>" + measuredLayer(report, unit, stride, enlarged) + "</g>";
  if (enlarged > 1.0) svg += "<g class=atscale>" + measuredLayer(report, unit, stride, 1.0) + "</g>";
  return svg + fmt::format("{}</g>{}</svg><figcaption>Unit {}</figcaption></figure>", marks.upright,
                           marks.labels, unit);
}

/// The largest deviation that the panels draw, mm.
double largestDrawn_mm(const RunReport& report, const std::vector<int>& units) {
  double largest_mm = 0.0;
  for (const vision::EntityKerf& kerf : report.kerf.entities) {
    if (std::find(units.begin(), units.end(), kerf.unit) == units.end()) continue;
    for (const vision::Caliper& c : kerf.calipers)
      if (isShown(c)) largest_mm = std::max(largest_mm, std::abs(c.offset_mm));
  }
  return largest_mm;
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
  const double enlarged = exaggerationFor(std::max(largestDrawn_mm(report, units), report.limits.path_mm),
                                          report.dieline->bounds().sizes().maxCoeff());
  std::string html = "<div class=legend><span class=key><i class=kn></i>dieline</span>";
  html += limitLegend(report.limits.path_mm);
  html +=
      "<span class=key><i class=km></i>no kerf found</span><span class=key><i class=ks></i>stray "
      "burn</span></div>";
  if (enlarged > 1.0) {
    html += fmt::format(
        "<input type=radio class=scale name=scale id=scale-large checked><label "
        "for=scale-large>deviations {:.0f} times enlarged</label><input type=radio class=scale name=scale "
        "id=scale-true><label for=scale-true>true scale</label>",
        enlarged);
  }
  html += "<div class=panels>";
  for (const int unit : units) html += panel(report, unit, stride, enlarged);
  html += "</div><p class=note>";
  html += enlarged > 1.0
              ? fmt::format(
                    "<span class=forenlarged>Deviations are drawn {:.0f} times enlarged, across the "
                    "line. </span>",
                    enlarged)
              : "The cut is drawn at true scale: its deviations can be seen as they are. ";
  html += fmt::format(
      "A line leads to its row of the table; numbered circles are the worst places, shown below.{}{}</p>",
      stride > 1 ? fmt::format(" Of every {} stations the worst is drawn.", stride) : std::string(),
      static_cast<std::size_t>(report.print.units) > units.size()
          ? fmt::format(" {} of {} units are shown, the worst ones.", units.size(), report.print.units)
          : std::string());
  return html;
}

double exaggerationFor(double largest_mm, double drawing_mm) {
  const double most = std::min(kLargestShare * drawing_mm / largest_mm, kMostExaggerated);
  if (!(most > 1.0)) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0})
    if (step * decade <= most) return step * decade;
  return decade;
}

std::string dielineSymbol(const RunReport& report) {
  const Eigen::AlignedBox2d box = report.dieline->bounds();
  if (box.isEmpty()) return {};
  return fmt::format(
      "<svg width=0 height=0 aria-hidden=true style='position:absolute'><defs><path id=dieline class=nominal "
      "d='{}'/></defs></svg>",
      nominalPath(report, box.sizes().maxCoeff()));
}

std::string placeOnDieline(const RunReport& report, const inspect::Whereabouts& where) {
  if (!where.hasPlace() || report.dieline->bounds().isEmpty()) return {};
  const View view = viewOf(*report.dieline, 0.0);
  const double r = 2.5 * view.dot();
  return fmt::format(
      "<figure><svg class=die viewBox='{}' role=img aria-label='Where it is on the drawing'><g "
      "transform='scale(1 -1)'><use href='#dieline'/><circle class=spot cx={:.2f} cy={:.2f} r={:.2f} "
      "/></g></svg><figcaption>The place on unit {}</figcaption></figure>",
      view.box(), where.x_mm, where.y_mm, r, where.unit);
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
  return htmlFold("drawing", "Show processes, size, pieces and holes, and what lint finds",
                  "<figure>" + svg + "</figure>");
}

}  // namespace kerfbench::report
