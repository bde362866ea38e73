// SPDX-License-Identifier: Apache-2.0
// Whether perforations have the cuts and bridges that were ordered, each as long and where it belongs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// From this share of the usual light on a station counts as open.
constexpr double kHalfLight = 0.5;
/// How far an edge may be off where two readings have it, half a pixel of a usual camera; a length has two
/// edges (k = 2).
constexpr double kEdgeU_mm = 0.02;

/// A line that turns by more than this has a corner there, at which the pattern begins anew.
constexpr double kCorner_rad = 0.05;

/// Perforated entities of one unit, end to end and without a corner, as one pattern lies over them. The line
/// runs as the first of them is drawn; others may be drawn the other way.
struct Line {
  struct Piece {
    int entity{};
    bool backward{};
  };
  std::vector<Piece> pieces;
  bool closed{};
  /// Ends at which no other perforation goes on: there the line begins and ends with a cut.
  bool free_start{}, free_end{};
};

/// A station along a line.
struct LightReading {
  double at_mm{};
  double light{};  ///< Share of the usual light of a cut, 0 … 1.
  bool unsure{};   ///< Light of other kerfs may come through.
};

/// Where a cut begins or ends, along a line.
struct Edge {
  double at_mm{};
  bool begins{};  ///< A cut begins here; else it ends.
  bool sure{};
};

/// The order laid over a line: cuts at phase + k period, each `cut_mm` long.
struct Pattern {
  double cut_mm{}, bridge_mm{};
  double phase_mm{};
  [[nodiscard]] double period_mm() const { return cut_mm + bridge_mm; }
};

class LineFinder {
 public:
  explicit LineFinder(const dieline::Dieline& dieline) : dieline_(dieline) {
    for (const dieline::Entity& entity : dieline.entities)
      if (entity.process == dieline::Process::kPerforation) ids_.push_back(entity.id);
  }

  [[nodiscard]] std::vector<Line> lines() {
    std::vector<Line> lines;
    std::vector<int> left = ids_;
    while (!left.empty()) {
      Line line;
      line.pieces.push_back({left.front(), false});
      left.erase(left.begin());
      extend(line, left);
      lines.push_back(std::move(line));
    }
    return lines;
  }

 private:
  struct End {
    int entity{};
    bool at_start{};
    bool operator==(const End&) const = default;
  };

  [[nodiscard]] const dieline::Curve& curveOf(int id) const {
    return dieline_.entities[static_cast<std::size_t>(id)].curve;
  }
  [[nodiscard]] Eigen::Vector2d placeOf(const End& end) const {
    return dieline::pointAt(curveOf(end.entity), end.at_start ? 0.0 : 1.0);
  }
  /// Direction in which an entity leaves its end.
  [[nodiscard]] Eigen::Vector2d inwardOf(const End& end) const {
    const Eigen::Vector2d tangent = dieline::tangentAt(curveOf(end.entity), end.at_start ? 0.0 : 1.0);
    return end.at_start ? tangent : Eigen::Vector2d(-tangent);
  }
  /// Ends, of other entities or the other one of the same, at which this one goes on without a corner.
  [[nodiscard]] std::vector<End> partnersOf(const End& end) const {
    std::vector<End> partners;
    for (const int id : ids_) {
      for (const bool at_start : {true, false}) {
        const End other{id, at_start};
        if (other == end || (placeOf(other) - placeOf(end)).norm() > kMeet_mm) continue;
        if (inwardOf(other).dot(-inwardOf(end)) >= std::cos(kCorner_rad)) partners.push_back(other);
      }
    }
    return partners;
  }

  /// Goes on from the line's last piece as long as exactly one other begins there.
  [[nodiscard]] bool grow(Line& line, std::vector<int>& left) const {
    for (;;) {
      const Line::Piece& last = line.pieces.back();
      const std::vector<End> partners = partnersOf({last.entity, last.backward});
      if (partners.empty()) return true;
      if (partners.size() > 1) return false;
      const auto next = std::ranges::find(left, partners.front().entity);
      if (next == left.end()) {
        line.closed = partners.front().entity == line.pieces.front().entity;
        return false;
      }
      line.pieces.push_back({*next, !partners.front().at_start});
      left.erase(next);
    }
  }

  void extend(Line& line, std::vector<int>& left) const {
    line.free_end = grow(line, left);
    if (line.closed) return;
    turn(line);
    line.free_end = grow(line, left);
    turn(line);
  }

  static void turn(Line& line) {
    std::ranges::reverse(line.pieces);
    for (Line::Piece& piece : line.pieces) piece.backward = !piece.backward;
    std::swap(line.free_start, line.free_end);
  }

  const dieline::Dieline& dieline_;
  std::vector<int> ids_;
};

/// What the calipers of one unit read along a line.
struct Trace {
  double length_mm{};
  std::vector<double> starts_mm;  ///< Where along the line each piece begins.
  std::vector<LightReading> readings;
};

Trace traceOf(const Evidence& evidence, const Line& line, int unit) {
  Trace trace;
  std::vector<double> bright;
  for (const Line::Piece& piece : line.pieces) {
    trace.starts_mm.push_back(trace.length_mm);
    const double length_mm = dieline::lengthOf(entityOf(evidence, piece.entity).curve);
    for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
      if (kerf.unit != unit || kerf.entity != piece.entity) continue;
      for (const vision::LightReading& r : kerf.light) {
        const double along_mm = piece.backward ? length_mm - r.station_mm : r.station_mm;
        trace.readings.push_back({trace.length_mm + along_mm, r.brightness, r.near_joint});
        if (r.brightness >= kOpenBrightness) bright.push_back(r.brightness);
      }
    }
    trace.length_mm += length_mm;
  }
  std::ranges::stable_sort(trace.readings, {}, &LightReading::at_mm);
  const double usual = bright.empty() ? 1.0 : medianOf(std::move(bright));
  for (LightReading& reading : trace.readings) reading.light = std::clamp(reading.light / usual, 0.0, 1.0);
  return trace;
}

/// Where the light is half. A reading shows the mean of its window, and windows overlap, so the light falls
/// along a straight line there.
double edgeBetween(const LightReading& before, const LightReading& after) {
  const double share = (kHalfLight - before.light) / (after.light - before.light);
  return before.at_mm + share * (after.at_mm - before.at_mm);
}

std::vector<Edge> edgesOf(const Trace& trace, bool closed) {
  std::vector<Edge> edges;
  const auto add = [&](const LightReading& before, const LightReading& after) {
    const bool was_open = before.light >= kHalfLight;
    const bool is_open = after.light >= kHalfLight;
    if (was_open != is_open)
      edges.push_back({edgeBetween(before, after), is_open, !before.unsure && !after.unsure});
  };
  for (std::size_t i = 0; i + 1 < trace.readings.size(); ++i) add(trace.readings[i], trace.readings[i + 1]);
  if (!closed || trace.readings.empty()) return edges;
  LightReading again = trace.readings.front();
  again.at_mm += trace.length_mm;
  add(trace.readings.back(), again);
  if (edges.empty()) return edges;
  Edge round = edges.front();  // The last piece ends where the first began.
  round.at_mm += trace.length_mm;
  edges.push_back(round);
  return edges;
}

/// The order, stretched as little as it takes for a whole number of cuts.
Pattern patternOn(const Line& line, double length_mm, const Tolerances::Perforation& order) {
  const double period_mm = order.cut_mm + order.bridge_mm;
  const bool with_ends = line.free_start && line.free_end;
  const double wanted_mm = with_ends ? length_mm + order.bridge_mm : length_mm;
  const double cuts = std::max(1.0, std::round(wanted_mm / period_mm));
  const double stretch = length_mm / (cuts * period_mm - (with_ends ? order.bridge_mm : 0.0));
  return {order.cut_mm * stretch, order.bridge_mm * stretch, 0.0};
}

double wrapped(double value_mm, double period_mm) {
  return value_mm - period_mm * std::round(value_mm / period_mm);
}

/// Offset of an edge from where the pattern has it, without the phase.
double offsetOf(const Edge& edge, const Pattern& pattern) {
  return wrapped(edge.at_mm - pattern.phase_mm - (edge.begins ? 0.0 : pattern.cut_mm), pattern.period_mm());
}

/// Where the pattern lies, for a line that does not begin with a cut of its own: the mean of its edges on the
/// circle of a period.
double phaseFrom(const std::vector<Edge>& edges, const Pattern& pattern) {
  double sine = 0.0;
  double cosine = 0.0;
  const double turn = 2.0 * kPi / pattern.period_mm();
  for (const Edge& edge : edges) {
    const double angle = turn * offsetOf(edge, pattern);
    sine += std::sin(angle);
    cosine += std::cos(angle);
  }
  return std::atan2(sine, cosine) / turn;
}

/// A place of a line, on the entity that has it.
struct Drawn {
  int entity{};
  bool backward{};    ///< The entity is drawn against the line.
  double along_mm{};  ///< From the entity's drawn start.
};
Drawn drawnAt(const Line& line, const Trace& trace, double at_mm) {
  if (line.closed) at_mm = std::fmod(at_mm, trace.length_mm);
  std::size_t i = line.pieces.size() - 1;
  while (i > 0 && at_mm < trace.starts_mm[i]) --i;
  const Line::Piece& piece = line.pieces[i];
  const double end_mm = i + 1 < line.pieces.size() ? trace.starts_mm[i + 1] : trace.length_mm;
  return {piece.entity, piece.backward, piece.backward ? end_mm - at_mm : at_mm - trace.starts_mm[i]};
}

/// A departure from the order, in words that hold for the entity as it is drawn.
struct Departure {
  double mm{};
  std::string what;
  int entity{};
};

class Judged {
 public:
  Judged(const Line& line, const Trace& trace, const Pattern& pattern)
      : line_(line), trace_(trace), pattern_(pattern) {}

  void lengthOfPiece(const Edge& from, const Edge& to) {
    const double length_mm = to.at_mm - from.at_mm;
    const double ordered_mm = from.begins ? pattern_.cut_mm : pattern_.bridge_mm;
    ++(from.begins ? cuts_ : bridges_);
    Drawn drawn = drawnAt(line_, trace_, from.at_mm);
    // As drawn, it begins at its other end, or at the entity's start if that lies within.
    if (drawn.backward) drawn.along_mm = std::max(0.0, drawn.along_mm - length_mm);
    add(std::abs(length_mm - ordered_mm), drawn,
        fmt::format("a {} is {:.2f} mm long for {:.2f}", from.begins ? "cut" : "bridge", length_mm,
                    ordered_mm));
  }
  void place(const Edge& edge) {
    const Drawn drawn = drawnAt(line_, trace_, edge.at_mm);
    const double off_mm = offsetOf(edge, pattern_);
    add(std::abs(off_mm), drawn,
        fmt::format("a cut {} {:.2f} mm too {}", edge.begins != drawn.backward ? "begins" : "ends",
                    std::abs(off_mm), (off_mm < 0.0) != drawn.backward ? "early" : "late"));
  }
  [[nodiscard]] const std::optional<Departure>& worst() const { return worst_; }
  [[nodiscard]] std::size_t cuts() const { return cuts_; }
  [[nodiscard]] std::size_t bridges() const { return bridges_; }

 private:
  void add(double mm, const Drawn& drawn, const std::string& what) {
    if (worst_ && mm <= worst_->mm) return;
    worst_ = Departure{mm, fmt::format("{}, {:.1f} mm from its start", what, drawn.along_mm), drawn.entity};
  }

  const Line& line_;
  const Trace& trace_;
  const Pattern& pattern_;
  std::optional<Departure> worst_;
  std::size_t cuts_{}, bridges_{};
};

/// What is worst along one line; nothing where no reading is a single kerf's.
struct LineVerdict {
  std::optional<Departure> worst;
  std::size_t cuts{}, bridges{};
};
LineVerdict judge(const Line& line, const Trace& trace, const Tolerances::Perforation& order) {
  Pattern pattern = patternOn(line, trace.length_mm, order);
  const bool any_sure = std::ranges::any_of(trace.readings, [](const LightReading& r) { return !r.unsure; });
  std::vector<Edge> edges = edgesOf(trace, line.closed);
  if (edges.empty()) {
    if (!any_sure) return {};
    const bool open = trace.readings.front().light >= kHalfLight;
    const bool one_cut = line.free_start && line.free_end && pattern.cut_mm > trace.length_mm - 1e-6;
    const int entity = line.pieces.front().entity;
    if (open && one_cut) return {Departure{0.0, "the line is one cut", entity}, 1, 0};
    return {Departure{open ? pattern.bridge_mm : trace.length_mm,
                      open ? "it has no bridge at all" : "it is not cut at all", entity},
            0, 0};
  }
  if (!(line.free_start && line.free_end)) pattern.phase_mm = phaseFrom(edges, pattern);
  Judged judged(line, trace, pattern);
  for (const Edge& edge : edges)
    if (edge.sure) judged.place(edge);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (edges[i].sure && edges[i + 1].sure) judged.lengthOfPiece(edges[i], edges[i + 1]);
  return {judged.worst(), judged.cuts(), judged.bridges()};
}

}  // namespace

Finding perforationCheck(const Evidence& evidence, const Tolerances& limits) {
  Check check{.name = "perforation", .title = "Perforations have the cuts and bridges ordered", .unit = "mm"};
  check.limit = limits.perforation.limit_mm;
  check.value = kNan;
  const std::vector<Line> lines = LineFinder(*evidence.dieline).lines();
  if (lines.empty()) return notApplicable(check, "The dieline has no perforation.");
  if (!(limits.perforation.cut_mm > 0.0))
    return notJudged(check, "The scenario orders neither cuts nor bridges (checks.perforation).");
  std::size_t cuts = 0;
  std::size_t bridges = 0;
  std::string what;
  for (int unit = 0; unit < evidence.print.units; ++unit) {
    for (const Line& line : lines) {
      const LineVerdict verdict = judge(line, traceOf(evidence, line, unit), limits.perforation);
      cuts += verdict.cuts;
      bridges += verdict.bridges;
      if (!verdict.worst || verdict.worst->mm <= check.value) continue;
      check.value = verdict.worst->mm;
      check.subject = nameOf(unit, verdict.worst->entity);
      check.where = onLine(unit, verdict.worst->entity);
      what = verdict.worst->what;
    }
  }
  if (std::isnan(check.value))
    return notJudged(check, "All of the perforations lie where other kerfs are too near to read them.");
  check.u = check.guard = std::numbers::sqrt2 * kEdgeU_mm;
  decide(check);
  check.explanation = fmt::format(
      "Of {} cuts and {} bridges, ordered {:g} and {:g} mm long and stretched to whole cuts on each line, "
      "the "
      "worst is on {}: {}.",
      cuts, bridges, limits.perforation.cut_mm, limits.perforation.bridge_mm, check.subject, what);
  return check;
}

}  // namespace kerfbench::inspect::checks
