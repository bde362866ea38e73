// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/strip/strip_pictures.h"

#include "firmware_under_test/planner/strip/chart.h"

namespace kerfbench::planner {

std::string stripPathPicture(const StripPath& path) {
  std::vector<ChartCurve> curves;
  for (const StripSpan& span : path.spans()) {
    if (span.kind == StripSpan::Kind::kWait) continue;
    curves.push_back({std::string(nameOf(span.kind)) + " " + std::to_string(span.piece),
                      {span.from_mm, path.at(span, span.to_s).place_mm},
                      span.kind == StripSpan::Kind::kReturn});
  }
  return svgOf(
      {"Way of the head over the strip", "x along the feed, mm", "y across, mm", std::move(curves), false});
}

std::string stripLengthPicture(const StripPath& path) {
  ChartCurve length{"G(t)", {}, false};
  for (const StripSpan& span : path.spans()) {
    length.points.emplace_back(span.from_s, span.path_mm);
    length.points.emplace_back(span.to_s, path.at(span, span.to_s).path_mm);
  }
  return svgOf({"Length of the head's way", "time, s", "G, mm", {std::move(length)}, false});
}

std::string throughputPicture(const Throughput& throughput) {
  ChartCurve stops{"stop and go, by formula", {}, false}, planned_stops{"stop and go, with ramps", {}, true};
  ChartCurve runs{"on the run, by formula", {}, false}, planned_runs{"on the run, with ramps", {}, true};
  for (const Throughput::Times& row : throughput.times) {
    stops.points.emplace_back(row.pieces, row.stops_s);
    planned_stops.points.emplace_back(row.pieces, row.planned_stops_s);
    runs.points.emplace_back(row.pieces, row.runs_s);
    planned_runs.points.emplace_back(row.pieces, row.planned_runs_s);
  }
  return svgOf({"Time until the last piece is cut",
                "pieces",
                "time, s",
                {std::move(stops), std::move(planned_stops), std::move(runs), std::move(planned_runs)},
                true});
}

}  // namespace kerfbench::planner
