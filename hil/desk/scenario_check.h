// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// POST /api/check: what is wrong with a scenario, all at once, and what it would cut. Answers for faulty
/// text as well, with as much as can be read of it:
///
///     {"name", "title", "issues": [{"file", "line", "column", "severity", "message", "key"}],
///      "fits": bool,                                        no issue is an error
///      "drawing": null | {"file", "svg", "size_mm": [w, h], "min_mm": [x, y], "shown", "count",
///        "entities": [{"id", "layer", "process", "length_mm", "line", "origin", "points_mm": [[x, y] …],
///                      "closed", "left_out"}],                left_out: its process, were it selected
///        "findings": [{"kind", "severity", "message", "where_mm": [x, y], "entities": [id …], "line",
///                      "accepted"}],
///        "layers": [{"name", "process", "count", "length_mm"}], "notes": [text],
///        "unsaid_unit": null | {"line", "taken_mm", "name"}},   the file does not say how long a unit is
///      "values": {"belt.speed_mm_s": 60 …},                 as the file and those it extends say, flat
///      "own": ["belt.speed_mm_s" …],                        of these, the ones that this file says itself
///      "machine": null | {"file", "name", "kind", "field": {"min_mm", "max_mm"}, "full_power_w",
///                         "tracking_delay_s", "feeds": bool},
///      "sheet": null | {"marks": [{"x_mm", "y_mm", "diameter_mm"}], "pitch_mm", "units", "moves": bool,
///                       "start_x_mm": null | number}}         place of S under the head while it lies at
///                       rest
///
/// Line and column begin at 1; 0: unknown. Curves are flattened to 0.01 mm. Beyond kMostShown entities or
/// points the drawing's `entities` end, `shown` < `count` says so, and a note tells it; counts, lengths and
/// findings are those of the whole drawing. `svg` is a picture of the same lines in mm, y downwards, made of
/// numbers alone: no name of the drawing is in it.
std::string checkJson(const ScenarioText& scenario, const DeskRequest& request);

/// Bounds of what an answer shows of a drawing.
inline constexpr std::size_t kMostEntitiesShown = 100'000;
inline constexpr std::size_t kMostPointsShown = 1'000'000;

}  // namespace kerfbench::desk
