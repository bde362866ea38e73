// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/strip/strip_pictures.h"

#include <utility>

#include "hil/base/chart.h"

namespace kerfbench::planner {

using base::ChartCurve;

std::string stripPathPicture(const StripPath& path) {
  ChartCurve cuts{"cuts", {}, false}, ways_back{"ways back", {}, true};
  for (const StripSpan& span : path.spans()) {
    if (span.kind == StripSpan::Kind::kWait) continue;
    ChartCurve& curve = span.kind == StripSpan::Kind::kCut ? cuts : ways_back;
    curve.strokes.push_back({span.from_mm, path.at(span, span.to_s).place_mm});
  }
  return base::svgOf({"Way of the head over the strip",
                      "x along the feed, mm",
                      "y across, mm",
                      {std::move(cuts), std::move(ways_back)},
                      false,
                      true});
}

std::string stripLengthPicture(const StripPath& path) {
  ChartCurve length{"G(t)", {{}}, false};
  for (const StripSpan& span : path.spans()) {
    length.strokes.front().emplace_back(span.from_s, span.path_mm);
    length.strokes.front().emplace_back(span.to_s, path.at(span, span.to_s).path_mm);
  }
  return base::svgOf({"Length of the head's way", "time, s", "G, mm", {std::move(length)}, false});
}

std::string throughputPicture(const Throughput& throughput) {
  const auto curve = [&](const char* name, double Throughput::Times::*time_s, bool dashed) {
    ChartCurve::Stroke stroke;
    for (const Throughput::Times& row : throughput.times) stroke.emplace_back(row.pieces, row.*time_s);
    return ChartCurve{name, {std::move(stroke)}, dashed};
  };
  using Times = Throughput::Times;
  return base::svgOf({"Time until the last piece is cut",
                      "pieces",
                      "time, s",
                      {curve("stop and go, by formula", &Times::stops_s, false),
                       curve("stop and go, with ramps", &Times::planned_stops_s, true),
                       curve("on the run, by formula", &Times::runs_s, false),
                       curve("on the run, with ramps", &Times::planned_runs_s, true)},
                      true});
}

}  // namespace kerfbench::planner
