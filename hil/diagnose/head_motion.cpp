// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/head_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hil/base/chart.h"

namespace kerfbench::diagnose {
namespace {

using base::ChartCurve;
using Eigen::Vector2d;

/// Times of the instants: evenly, and at each edge of the gate.
std::vector<double> timesOf(const MotionSource& source, double every_s) {
  std::vector<double> times_s;
  for (long k = 0; static_cast<double>(k) * every_s < source.end_s; ++k)
    times_s.push_back(static_cast<double>(k) * every_s);
  times_s.push_back(source.end_s);
  for (const Vector2d& gate : source.gates_s) times_s.insert(times_s.end(), {gate[0], gate[1]});
  std::ranges::sort(times_s);
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  return times_s;
}

/// Strokes of a way, lit and dark; `place` of an instant may be NaN.
template <typename Place>
std::vector<ChartCurve> strokesOf(const HeadMotion& motion, const Place& place) {
  ChartCurve lit{"gate open", {}, false}, dark{"gate closed", {}, true};
  const MotionInstant* before = nullptr;
  for (const MotionInstant& now : motion.instants) {
    if (before != nullptr && place(*before).allFinite() && place(now).allFinite()) {
      ChartCurve& curve = before->lit ? lit : dark;
      const bool goes_on = !curve.strokes.empty() && curve.strokes.back().back() == place(*before);
      if (!goes_on) curve.strokes.push_back({place(*before)});
      curve.strokes.back().push_back(place(now));
    }
    before = &now;
  }
  return {std::move(lit), std::move(dark)};
}

}  // namespace

HeadMotion headMotion(const MotionSource& source, double every_s) {
  HeadMotion motion;
  double path_mm = 0.0;
  auto gate = source.gates_s.begin();
  for (const double time_s : timesOf(source, every_s)) {
    while (gate != source.gates_s.end() && time_s >= (*gate)[1]) ++gate;
    const bool lit = gate != source.gates_s.end() && time_s >= (*gate)[0];
    const Vector2d p_W_mm = source.place_W_mm(time_s);
    if (!motion.instants.empty()) {
      const double way_mm = (p_W_mm - motion.instants.back().p_W_mm).norm();
      if (std::isfinite(way_mm)) path_mm += way_mm;
    }
    motion.instants.push_back({time_s, p_W_mm, source.sheet_x_mm(time_s), lit, path_mm});
  }
  for (const Vector2d& span : source.gates_s) {
    if (span[1] > span[0])
      motion.cuts.push_back({span[0], span[1], source.place_W_mm(span[0]), source.place_W_mm(span[1]),
                             source.sheet_x_mm(span[1]) - source.sheet_x_mm(span[0])});
  }
  return motion;
}

std::string motionTable(const HeadMotion& motion) {
  std::string text = "t_s,x_W_mm,y_W_mm,sheet_x_mm,gate,G_mm\n";
  for (const MotionInstant& it : motion.instants)
    text += fmt::format("{:.6f},{:.4f},{:.4f},{:.4f},{},{:.4f}\n", it.time_s, it.p_W_mm.x(), it.p_W_mm.y(),
                        it.sheet_x_mm, it.lit ? 1 : 0, it.path_mm);
  return text;
}

std::string cutTable(const HeadMotion& motion) {
  std::string text = fmt::format("{:>9} {:>9} {:>21} {:>21} {:>19} {:>19}\n", "from s", "to s",
                                 "from x, y mm", "to x, y mm", "over the sheet mm", "mean vx, vy mm/s");
  for (const MotionCut& cut : motion.cuts) {
    const Vector2d sheet_mm = cut.overSheet_mm(), v = cut.velocityW();
    text += fmt::format(
        "{:>9.4f} {:>9.4f} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f} {:>9.3f} {:>9.3f} {:>9.2f} {:>9.2f}\n",
        cut.from_s, cut.to_s, cut.from_W_mm.x(), cut.from_W_mm.y(), cut.to_W_mm.x(), cut.to_W_mm.y(),
        sheet_mm.x(), sheet_mm.y(), v.x(), v.y());
  }
  return text;
}

std::string wayPicture(const HeadMotion& motion) {
  return base::svgOf({"Way of the head, by its pulses", "x_W along the belt, mm", "y_W across, mm",
                      strokesOf(motion, [](const MotionInstant& it) { return it.p_W_mm; }), false, true});
}

std::string sheetPicture(const HeadMotion& motion) {
  return base::svgOf(
      {"Way over the sheet, by pulses and encoder", "x_S, mm", "y_S, mm",
       strokesOf(motion,
                 [](const MotionInstant& it) { return Vector2d(it.p_W_mm - Vector2d(it.sheet_x_mm, 0.0)); }),
       false, true});
}

std::string lengthPicture(const HeadMotion& motion) {
  ChartCurve length{"G(t)", {{}}, false};
  for (const MotionInstant& it : motion.instants) length.strokes.front().emplace_back(it.time_s, it.path_mm);
  return base::svgOf(
      {"Length of the head's way, by its pulses", "time, s", "G, mm", {std::move(length)}, false});
}

}  // namespace kerfbench::diagnose
