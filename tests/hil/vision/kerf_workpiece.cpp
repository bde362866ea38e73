// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/vision/kerf_workpiece.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/scan/kerf_scan.h"

namespace kerfbench::vision::test {

using Eigen::Vector2d;

dieline::Curve line(const Vector2d& a, const Vector2d& b) { return dieline::LineCurve{a, b}; }
static dieline::Curve arc(const Vector2d& c, double r, double start, double sweep) {
  return dieline::ArcCurve{c, r, start, sweep};
}

dieline::Dieline manyDirections() {
  dieline::Dieline dieline;
  const auto add = [&](dieline::Curve curve, dieline::Process process = dieline::Process::kCut) {
    dieline.entities.push_back(
        {static_cast<int>(dieline.entities.size()), std::move(curve), process, "", ""});
  };
  add(line({6.0, 5.0}, {16.0, 5.0}));                                // E0
  add(line({18.0, 4.0}, {18.0, 12.0}));                              // E1
  add(line({21.0, 4.0}, {29.0, 9.3}));                               // E2
  add(line({6.0, 7.0}, {15.0, 11.7}));                               // E3
  add(arc({10.0, 18.0}, 3.5, 0.3, 5.0));                             // E4
  add(arc({20.0, 18.0}, 4.0, 0.0, 2.0 * 3.14159265358979));          // E5, a circle
  add(line({27.0, 12.0}, {34.0, 16.0}), dieline::Process::kCrease);  // E6
  add(line({27.0, 20.0}, {33.0, 20.0}));                             // E7 with E8 a corner
  add(line({33.0, 20.0}, {33.0, 23.0}));                             // E8
  add(line({30.0, 4.0}, {34.0, 4.0}));                               // E9 and E10 run on into each other
  add(line({34.0, 4.0}, {38.0, 4.0}));                               // E10
  add(line({36.0, 10.0}, {36.0, 20.0}));                             // E11, E12 neighbours at 0.4 mm
  add(line({36.4, 10.0}, {36.4, 20.0}));                             // E12
  add(line({1.0, 1.0}, {2.0, 1.0}), dieline::Process::kIgnore);      // E13
  return dieline;
}

PrintLayout marksAtCorners(int units) {
  PrintLayout print;
  print.units = units;
  print.pitch_mm = 60.0;
  print.marks = {{{2.5, 22.0}, 3.0}, {{2.5, 4.5}, 3.0}, {{39.0, 24.0}, 3.0}, {{39.5, 6.5}, 3.0}};
  return print;
}

void Workpiece::drawKerf(Canvas& canvas, const Vector2d& p_TV, const dieline::Curve& curve,
                         const Truth& t) const {
  // Short boxes along the curve keep the supersampling near it.
  const std::vector<double> us = dieline::stations(curve, 0.8);
  const double length = dieline::lengthOf(curve);
  for (std::size_t i = 0; i + 1 < us.size(); ++i) {
    Eigen::AlignedBox2d box;
    for (const double u : {us[i], 0.5 * (us[i] + us[i + 1]), us[i + 1]}) {
      box.extend(tableFromSheet(dieline::pointAt(curve, u)) - p_TV);
    }
    const double margin = std::abs(t.offset_mm) + t.width_mm + 0.1;
    box = Eigen::AlignedBox2d(box.min().array() - margin, box.max().array() + margin);
    const Eigen::AlignedBox2d view(Vector2d(-14.5, -11.5), Vector2d(14.5, 11.5));
    if (!view.intersects(box)) continue;
    const bool first = i == 0;
    const bool last = i + 2 == us.size();
    canvas.shape(box, t.gray, [&](const Vector2d& p_V) {
      const Vector2d p_S = sheetFromTable(p_TV + p_V);
      const dieline::Nearest nearest = dieline::nearestOn(curve, p_S);
      if (nearest.u < us[i] - (first ? 1.0 : 0.0) || nearest.u > us[i + 1] + (last ? 1.0 : 0.0)) return false;
      const double s = nearest.u * length;
      if (s > t.gap_begin_mm && s < t.gap_end_mm) return false;
      const Vector2d tangent = dieline::tangentAt(curve, nearest.u);
      const Vector2d d = p_S - dieline::pointAt(curve, nearest.u);
      const double across = tangent.x() * d.y() - tangent.y() * d.x() - t.offset_mm;
      const double along = std::max(0.0, std::abs(d.dot(tangent)));
      return std::hypot(across, along) < 0.5 * t.width_mm;
    });
  }
}

std::vector<camera::KerfTile> Workpiece::tiles(int unit) const {
  std::vector<camera::KerfTile> out;
  for (const double y : {8.0, 20.0}) {
    for (const double x : {11.0, 31.0}) {
      const Vector2d p_TV(x, y);
      Canvas canvas(camera, kBoard);
      for (const RegistrationMark& mark : print.marks) {
        const Vector2d p_V = tableFromSheet(mark.p_SM_mm) - p_TV;
        if (camera.pixelIfSeen(p_V, -60.0)) canvas.disc(p_V, mark.diameter_mm, kInk);
      }
      for (const dieline::Entity& entity : dieline.entities) {
        if (entity.process == dieline::Process::kIgnore) continue;
        Truth t;
        if (entity.process == dieline::Process::kCrease) t.gray = kCrease;
        if (const auto told = truth.find(entity.id); told != truth.end()) t = told->second;
        if (t.cut) drawKerf(canvas, p_TV, entity.curve, t);
      }
      for (const dieline::Curve& curve : extra) drawKerf(canvas, p_TV, curve, Truth{});
      canvas.blur(kLensPx);
      out.push_back({canvas.expose(11, out.size()), p_TV, unit});
    }
  }
  return out;
}

KerfScan Workpiece::scan(std::vector<camera::KerfTile> some) const {
  ReadyTiles source(std::move(some));
  return scanKerf(source, camera, print, dieline, options);
}

}  // namespace kerfbench::vision::test
