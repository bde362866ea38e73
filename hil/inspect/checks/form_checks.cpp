// SPDX-License-Identifier: Apache-2.0
// What the kerf looks like: depth, width, ends.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/interval_words.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "hil/vision/kerf/kerf_profile.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// How far from an end a gap is looked for; a hole further in is a matter of coverage.
constexpr double kEndWindow_mm = 1.0;

using Stations = std::vector<const vision::Caliper*>;

/// Which stations are found and as bright as that.
std::vector<bool> brightStations(const Stations& stations, double brightness) {
  std::vector<bool> bright;
  for (const vision::Caliper* c : stations) bright.push_back(c->found && c->brightness >= brightness);
  return bright;
}

/// Which stations are through for certain: as bright as `surely_open`, or open and so near to one that is
/// that their calipers reach over its end.
std::vector<bool> openForCertain(const Stations& stations, double surely_open) {
  const std::vector<bool> open = brightStations(stations, kOpenBrightness);
  const std::vector<bool> certain = brightStations(stations, surely_open);
  std::vector<bool> result = certain;
  const auto beside = [&](std::size_t i, std::size_t k) {
    const double apart_mm = std::abs(stations[i]->station_mm - stations[k]->station_mm);
    return certain[k] && apart_mm <= 1.01 * vision::kWindowHalfMm;
  };
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (!open[i]) continue;
    if (i > 0 && beside(i, i - 1)) result[i] = true;
    if (i + 1 < stations.size() && beside(i, i + 1)) result[i] = true;
  }
  return result;
}

/// The longest run of such neighbouring stations, mm: from half a station before the first to half a station
/// behind the last.
double longestRun_mm(const Stations& stations, const std::vector<bool>& such) {
  double longest_mm = 0.0;
  for (std::size_t first = 0; first < stations.size(); ++first) {
    if (!such[first]) continue;
    std::size_t last = first;
    while (last + 1 < stations.size() && such[last + 1]) ++last;
    const double before_mm = first > 0 ? stations[first]->station_mm - stations[first - 1]->station_mm : 0.0;
    const double behind_mm =
        last + 1 < stations.size() ? stations[last + 1]->station_mm - stations[last]->station_mm : 0.0;
    const double within_mm = stations[last]->station_mm - stations[first]->station_mm;
    longest_mm = std::max(longest_mm, within_mm + 0.5 * (before_mm + behind_mm));
    first = last;
  }
  return longest_mm;
}

/// Usual light of the cuts, 1 where there are none: how bright an open kerf is in these pictures.
double lightOfCuts(const Evidence& evidence) {
  std::vector<double> brightness;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    if (entityOf(evidence, kerf.entity).process != dieline::Process::kCut) continue;
    for (const vision::Caliper& c : kerf.calipers)
      if (c.found && !c.near_joint) brightness.push_back(c.brightness);
  }
  return brightness.empty() ? 1.0 : medianOf(std::move(brightness));
}

struct EndGap {
  double gap_mm{};
  double pitch_mm{};  ///< Distance of the two stations between which the kerf begins.
};

/// Length from the end of the curve to where the kerf is bright for good. `from_end` gives the calipers in
/// order from that end. The innermost rise within the window counts: at the very end the kerf of a neighbour
/// may shine.
template <typename Range, typename Distance>
EndGap gapAt(const Range& from_end, const Distance& distanceOf, double threshold) {
  EndGap result;
  const vision::Caliper* previous = nullptr;
  for (const vision::Caliper& c : from_end) {
    const double distance_mm = distanceOf(c);
    if (previous == nullptr) {
      result.pitch_mm = distance_mm;
    } else if (previous->brightness < threshold) {
      const double before_mm = distanceOf(*previous);
      result.pitch_mm = distance_mm - before_mm;
      result.gap_mm = distance_mm;  // Still dark, unless the kerf begins on the way here.
      if (c.brightness >= threshold) {
        const double share = (threshold - previous->brightness) / (c.brightness - previous->brightness);
        result.gap_mm = before_mm + share * result.pitch_mm;
      }
    }
    if (distance_mm > kEndWindow_mm) break;
    previous = &c;
  }
  return result;
}

}  // namespace

bool isPartial(dieline::Process process) {
  return process == dieline::Process::kCrease || process == dieline::Process::kHalfCut;
}

Finding depthCheck(const Evidence& evidence, const Tolerances& limits) {
  Check check{.name = "depth", .title = "Creases and half-cuts are not cut through", .unit = "mm"};
  check.limit = limits.cut_through_mm;
  const double surely_open = std::max(kOpenBrightness, kSurelyOpenShare * lightOfCuts(evidence));
  const vision::EntityKerf* worst = nullptr;
  Bounds longest;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    if (!isPartial(entityOf(evidence, kerf.entity).process)) continue;
    Stations stations;
    for (const vision::Caliper& c : kerf.calipers)
      if (!c.near_joint) stations.push_back(&c);
    const Bounds open{longestRun_mm(stations, openForCertain(stations, surely_open)),
                      longestRun_mm(stations, brightStations(stations, kOpenBrightness))};
    if (worst != nullptr && !open.isWorseThan(longest, check.limit)) continue;
    longest = open;
    worst = &kerf;
  }
  if (worst == nullptr) return notApplicable(check, "The dieline has no crease and no half-cut.");
  longest.decideIn(check, pitchOf(*worst));
  if (check.value == 0.0) {
    check.explanation = "No crease or half-cut lets the full light through.";
    return check;
  }
  check.subject = nameOf(worst->unit, worst->entity);
  check.where = onLine(worst->unit, worst->entity);
  check.explanation =
      longest.least_mm == longest.most_mm
          ? fmt::format("{} is cut through over {:.2f} mm without a break, longer than any other.",
                        check.subject, check.value)
          : fmt::format(
                "{} lets through nearly the light of a cut over {:.2f} mm without a break, and as much as "
                "a cut over {:.2f} mm: it is cut through there, or its floor is thin and clear.",
                check.subject, check.value, longest.least_mm);
  return check;
}

Check kerfWidthCheck(const Evidence& evidence, const Tolerances& limits,
                     const std::vector<EntityResult>& entities) {
  Check check{.name = "kerf_width", .title = "All kerfs of a process are equally wide", .unit = "mm"};
  check.limit = limits.kerf_width_mm;
  std::map<dieline::Process, std::vector<double>> widths;
  std::size_t judged = 0;
  for (const EntityResult& e : entities) {
    if (!std::isfinite(e.width_mm)) continue;
    widths[entityOf(evidence, e.entity).process].push_back(e.width_mm);
    ++judged;
  }
  std::map<dieline::Process, double> usual;
  for (const auto& [process, values] : widths) usual[process] = medianOf(values);

  ExtremeEstimate extreme(judged);
  const EntityResult* worst = nullptr;
  double worst_change_mm = 0.0;
  for (const EntityResult& e : entities) {
    if (!std::isfinite(e.width_mm)) continue;
    const double change_mm = e.width_mm - usual[entityOf(evidence, e.entity).process];
    extreme.add(change_mm, 0.5 * e.width_own_U_mm);
    if (worst == nullptr || std::abs(change_mm) > std::abs(worst_change_mm)) {
      worst = &e;
      worst_change_mm = change_mm;
    }
  }
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  decide(check);
  if (worst == nullptr) {
    check.explanation = "No kerf width could be measured.";
    return check;
  }
  const dieline::Process process = entityOf(evidence, worst->entity).process;
  check.subject = nameOf(worst->unit, worst->entity);
  check.where = onLine(worst->unit, worst->entity);
  check.explanation = fmt::format(
      "{} is {:.3f} mm wide, {:.3f} mm {} than is usual for its process ({}, {:.3f} mm).", check.subject,
      worst->width_mm, std::abs(worst_change_mm), worst_change_mm < 0.0 ? "narrower" : "wider",
      dieline::processName(process), usual[process]);
  check.explanation += intervalWords(check);
  return check;
}

namespace {

/// From which brightness on a kerf counts as burnt: half of what is usual along a crease or half-cut.
double burntThreshold(const vision::EntityKerf& kerf, dieline::Process process) {
  if (!isPartial(process)) return 0.5;
  std::vector<double> levels;
  for (const vision::Caliper& c : kerf.calipers) levels.push_back(c.brightness);
  return 0.5 * medianOf(std::move(levels));
}

/// What is not burnt at the start and at the end of a line.
std::array<EndGap, 2> endGaps(const vision::EntityKerf& kerf, const dieline::Entity& entity) {
  const double threshold = burntThreshold(kerf, entity.process);
  const double length_mm = dieline::lengthOf(entity.curve);
  const std::vector<vision::Caliper> backward(kerf.calipers.rbegin(), kerf.calipers.rend());
  return {gapAt(
              kerf.calipers, [](const vision::Caliper& c) { return c.station_mm; }, threshold),
          gapAt(
              backward, [&](const vision::Caliper& c) { return length_mm - c.station_mm; }, threshold)};
}

/// A perforation may begin with a bridge, a closed curve has no end, and an entity that is not there at all
/// is a matter of coverage.
bool hasJudgedEnds(const vision::EntityKerf& kerf, const dieline::Entity& entity, double coverage) {
  return entity.process != dieline::Process::kPerforation && !dieline::isClosed(entity.curve) &&
         !(coverage < 0.5) && kerf.calipers.size() >= 3;
}

}  // namespace

Finding laserTimingCheck(const Evidence& evidence, const Tolerances& limits,
                         const std::vector<EntityResult>& entities, const EdgeSides* edges) {
  const double half_kerf_mm = edges != nullptr ? halfKerf(evidence.kerf, *edges) : 0.0;
  Check check{.name = "laser_timing",
              .title = "The laser burns from the first to the last point of each line",
              .unit = "mm"};
  check.limit = limits.end_gap_mm;
  check.value = kNan;
  std::size_t ends = 0;
  std::size_t late = 0;
  bool at_start = true;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const vision::EntityKerf& kerf = evidence.kerf.entities[i];
    const dieline::Entity& entity = entityOf(evidence, kerf.entity);
    if (!hasJudgedEnds(kerf, entity, entities[i].coverage)) continue;
    std::array<EndGap, 2> gaps = endGaps(kerf, entity);
    for (EndGap& gap : gaps) {
      ++ends;
      if (edges != nullptr) {
        const double shortened_mm =
            shortenedBy(evidence.kerf, *evidence.dieline, *edges, half_kerf_mm, kerf, &gap == &gaps[0]);
        gap.gap_mm = std::max(0.0, gap.gap_mm - shortened_mm);
      }
      if (gap.gap_mm > limits.end_gap_mm) ++late;
      if (!std::isnan(check.value) && gap.gap_mm <= check.value) continue;
      check.value = gap.gap_mm;
      // The rise is a straight line between two stations: a quarter of their distance covers what it may
      // hide.
      check.u = check.guard = gap.gap_mm > 0.0 ? 0.25 * gap.pitch_mm : 0.0;
      check.subject = nameOf(kerf.unit, kerf.entity);
      at_start = &gap == &gaps[0];
      check.where = atPlace(kerf.unit, kerf.entity, dieline::pointAt(entity.curve, at_start ? 0.0 : 1.0));
    }
  }
  if (ends == 0) return notApplicable(check, "No line of the dieline ends freely, so none can be short.");
  decide(check);
  check.explanation = check.value == 0.0 ? fmt::format("The kerf reaches all {} line ends.", ends)
                                         : fmt::format(
                                               "At the {} of {} the first {:.2f} mm are not burnt; {} of {} "
                                               "line ends are short by more than "
                                               "{:.2f} mm. Short starts mean that gate or power come late, "
                                               "or rise too slowly with the speed.",
                                               at_start ? "start" : "end", check.subject, check.value, late,
                                               ends, limits.end_gap_mm);
  return check;
}

}  // namespace kerfbench::inspect::checks
