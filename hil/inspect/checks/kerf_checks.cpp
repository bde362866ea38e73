// SPDX-License-Identifier: Apache-2.0
// Whether the cut is there: coverage, stray; holes in the evidence.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "hil/vision/kerf/kerf_profile.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

double coverageOf(const vision::EntityKerf& kerf, const dieline::Entity& entity, const Tolerances& limits) {
  const auto inner = innerStations(kerf, entity.curve, limits.end_gap_mm);
  if (inner.empty()) return 0.0;
  const auto good = std::count_if(inner.begin(), inner.end(), [&](const vision::Caliper* c) {
    return isBurntAsAsked(*c, entity.process);
  });
  return static_cast<double>(good) / static_cast<double>(inner.size());
}

/// Readings whose error nobody states.
std::vector<std::string> uncertaintyProblems(const Evidence& evidence) {
  if (!evidence.kerf_calibration) return {"There is no calibration of the kerf camera."};
  std::vector<std::string> problems;
  std::set<int> placed;
  for (const vision::UnitPose& pose : evidence.kerf.units) placed.insert(pose.unit);
  std::size_t unstated = 0;
  std::set<int> unplaced;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    for (const vision::Caliper& c : kerf.calipers) {
      if (!judgesOffset(c)) continue;
      if (!(c.sigma_mm > 0.0) || !std::isfinite(c.sigma_mm)) ++unstated;
      if (!placed.contains(kerf.unit)) unplaced.insert(kerf.unit);
    }
  }
  if (unstated > 0) problems.push_back(fmt::format("{} kerf readings state no uncertainty.", unstated));
  for (const int unit : unplaced)
    problems.push_back(fmt::format("Nothing tells how well unit {} was placed on the table.", unit));
  return problems;
}

/// Stations beyond a stretch whose calipers reach into it.
constexpr std::size_t kBesideStretch = 2;

/// A groove keeps its place from station to station within this, over so many stations to each side.
constexpr double kSteady_mm = 0.05;
constexpr std::size_t kSteadyStations = 4;
/// Least share of the stations around that bear a faint groove out. Grain of the board is found here and
/// there.
constexpr double kSteadyShare = 0.75;

/// Which stations show that something was burnt, however dim: it is found, and lies where it does at most
/// stations around. Those near a joint, where nobody knows whose light it is, go with their neighbours; so
/// does one that noise hides, if it is at least half as bright as they are.
std::vector<bool> burntStations(const std::vector<const vision::Caliper*>& stations) {
  std::vector<bool> burnt(stations.size());
  const auto around = [&](std::size_t i) {
    return std::pair{i < kSteadyStations ? 0 : i - kSteadyStations,
                     std::min(i + kSteadyStations, stations.size() - 1)};
  };
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (!stations[i]->found || stations[i]->near_joint) continue;
    const auto [from, to] = around(i);
    double steady = 0.0;
    double seen = 0.0;
    for (std::size_t k = from; k <= to; ++k) {
      if (stations[k]->near_joint) continue;
      seen += 1.0;
      if (stations[k]->found && std::abs(stations[k]->offset_mm - stations[i]->offset_mm) < kSteady_mm)
        steady += 1.0;
    }
    burnt[i] = seen > static_cast<double>(kSteadyStations) && steady >= kSteadyShare * seen;
  }
  const std::vector<bool> alone = burnt;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (stations[i]->found && !stations[i]->near_joint) continue;
    const auto [from, to] = around(i);
    std::vector<double> brightness;
    for (std::size_t k = from; k <= to; ++k)
      if (alone[k]) brightness.push_back(stations[k]->brightness);
    if (brightness.empty()) continue;
    burnt[i] = stations[i]->near_joint || stations[i]->brightness >= 0.5 * medianOf(std::move(brightness));
  }
  return burnt;
}

/// Light at a station as a share of what is usual on its line.
double lightShare(const vision::Caliper& caliper, double usual) {
  return std::clamp(caliper.brightness / usual, 0.0, 1.0);
}

}  // namespace

bool isOpen(const vision::Caliper& caliper) { return caliper.brightness >= kOpenBrightness; }

bool isBurntAsAsked(const vision::Caliper& caliper, dieline::Process process) {
  if (!caliper.near_joint && !caliper.found) return false;
  if (process == dieline::Process::kCut || process == dieline::Process::kPerforation) return isOpen(caliper);
  return caliper.brightness >= kBurntBrightness && (caliper.near_joint || !isOpen(caliper));
}

Stretch longestStretch(const std::vector<const vision::Caliper*>& stations,
                       const std::function<bool(const vision::Caliper&)>& missing) {
  std::vector<double> burnt;
  for (const vision::Caliper* c : stations)
    if (!missing(*c)) burnt.push_back(c->brightness);
  const double usual = burnt.empty() ? 1.0 : std::max(medianOf(std::move(burnt)), kBurntBrightness);
  Stretch longest;
  for (std::size_t first = 0; first < stations.size(); ++first) {
    if (!missing(*stations[first])) continue;
    std::size_t last = first;
    while (last + 1 < stations.size() && missing(*stations[last + 1])) ++last;
    // A caliper shows the mean of its length, so what its neighbours lack of light adds up to the missing
    // piece.
    double lacking_mm = 0.0;
    const std::size_t from = first < kBesideStretch ? 0 : first - kBesideStretch;
    const std::size_t to = std::min(last + kBesideStretch, stations.size() - 1);
    for (std::size_t i = from; i < to; ++i) {
      const double lacking = 2.0 - lightShare(*stations[i], usual) - lightShare(*stations[i + 1], usual);
      lacking_mm += 0.5 * lacking * (stations[i + 1]->station_mm - stations[i]->station_mm);
    }
    // All along a line that lacks only part of its light every station counts.
    const double span_mm = stations[last]->station_mm - stations[first]->station_mm - vision::kWindowHalfMm;
    const double length_mm = std::max(lacking_mm, span_mm);
    if (length_mm > longest.length_mm)
      longest = {stations[first]->station_mm, stations[last]->station_mm, length_mm};
    first = last;
  }
  return longest;
}

bool isUncut(const vision::Caliper& caliper, dieline::Process process) {
  if (!caliper.near_joint && !caliper.found) return true;
  const bool through = process == dieline::Process::kCut || process == dieline::Process::kPerforation;
  return caliper.brightness < (through ? kOpenBrightness : kBurntBrightness);
}

Stretch longestUncut(const Evidence& evidence, const vision::EntityKerf& kerf, const Tolerances& limits) {
  const dieline::Entity& entity = entityOf(evidence, kerf.entity);
  return longestStretch(innerStations(kerf, entity.curve, limits.end_gap_mm),
                        [&](const vision::Caliper& c) { return isUncut(c, entity.process); });
}

Stretch longestBlank(const Evidence& evidence, const vision::EntityKerf& kerf, const Tolerances& limits) {
  const dieline::Entity& entity = entityOf(evidence, kerf.entity);
  if (!isPartial(entity.process)) return longestUncut(evidence, kerf, limits);
  const auto stations = innerStations(kerf, entity.curve, limits.end_gap_mm);
  const std::vector<bool> burnt = burntStations(stations);
  std::set<const vision::Caliper*> blank;
  for (std::size_t i = 0; i < stations.size(); ++i)
    if (!burnt[i] && isUncut(*stations[i], entity.process)) blank.insert(stations[i]);
  return longestStretch(stations, [&](const vision::Caliper& c) { return blank.contains(&c); });
}

bool Bounds::isWorseThan(const Bounds& other, double limit_mm) const {
  const double sure = std::max(least_mm, limit_mm);
  const double others = std::max(other.least_mm, limit_mm);
  return sure != others ? sure > others : most_mm > other.most_mm;
}

void Bounds::decideIn(Check& check, double pitch_mm) const {
  check.value = most_mm;
  check.u = check.guard = 0.0;
  if (most_mm > 0.0) check.u = check.guard = 0.5 * pitch_mm + most_mm - least_mm;
  decide(check);
}

double pitchOf(const vision::EntityKerf& kerf) {
  double pitch_mm = 0.0;
  for (std::size_t i = 1; i < kerf.calipers.size(); ++i)
    pitch_mm = std::max(pitch_mm, kerf.calipers[i].station_mm - kerf.calipers[i - 1].station_mm);
  return pitch_mm;
}

std::vector<const vision::Caliper*> innerStations(const vision::EntityKerf& kerf, const dieline::Curve& curve,
                                                  double end_mm) {
  std::vector<const vision::Caliper*> inner;
  std::vector<const vision::Caliper*> all;
  const double length_mm = dieline::lengthOf(curve);
  const bool closed = dieline::isClosed(curve);
  for (const vision::Caliper& c : kerf.calipers) {
    all.push_back(&c);
    if (closed || (c.station_mm >= end_mm && c.station_mm <= length_mm - end_mm)) inner.push_back(&c);
  }
  return inner.empty() ? all : inner;
}

double coverageOf(const Evidence& evidence, const vision::EntityKerf& kerf, const Tolerances& limits) {
  return coverageOf(kerf, evidence.dieline->entities[static_cast<std::size_t>(kerf.entity)], limits);
}

bool isBlank(const std::vector<EntityResult>& entities) {
  return std::all_of(entities.begin(), entities.end(),
                     [](const EntityResult& e) { return e.coverage < 0.05 && std::isnan(e.worst_mm); });
}

bool isElsewhere(const Evidence& evidence) {
  std::size_t stations = 0;
  std::size_t uncut = 0;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    const dieline::Process process = entityOf(evidence, kerf.entity).process;
    if (process == dieline::Process::kPerforation) continue;
    stations += kerf.calipers.size();
    uncut += static_cast<std::size_t>(
        std::ranges::count_if(kerf.calipers, [&](const vision::Caliper& c) { return isUncut(c, process); }));
  }
  return 2 * uncut > stations;
}

std::vector<std::string> kerfProblems(const Evidence& evidence) {
  std::vector<std::string> problems;
  std::set<std::pair<int, int>> scanned;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    if (!scanned.emplace(kerf.unit, kerf.entity).second) {
      problems.push_back(nameOf(kerf.unit, kerf.entity) + " was scanned twice.");
    }
    if (kerf.calipers.empty()) problems.push_back(nameOf(kerf.unit, kerf.entity) + " has no stations.");
    const auto broken =
        std::count_if(kerf.calipers.begin(), kerf.calipers.end(), [](const vision::Caliper& c) {
          return !std::isfinite(c.brightness) || (c.found && !c.near_joint && !std::isfinite(c.offset_mm));
        });
    if (broken > 0) {
      problems.push_back(fmt::format("{}: {} stations have a reading that is no number.",
                                     nameOf(kerf.unit, kerf.entity), broken));
    }
  }
  std::size_t missing = 0;
  std::string first;
  for (int unit = 0; unit < evidence.print.units; ++unit) {
    for (const dieline::Entity& entity : evidence.dieline->entities) {
      if (entity.process == dieline::Process::kIgnore || scanned.contains({unit, entity.id})) continue;
      if (missing++ == 0) first = nameOf(unit, entity.id);
    }
  }
  if (missing > 0) {
    problems.push_back(
        fmt::format("{} of the entities were never scanned, the first is {}.", missing, first));
  }
  const auto uncertainty = uncertaintyProblems(evidence);
  problems.insert(problems.end(), uncertainty.begin(), uncertainty.end());
  return problems;
}

namespace {

/// How long the longest uncut piece of an entity is, of which longestUncut() says the most.
Bounds uncutOf(const Evidence& evidence, const Tolerances& limits, std::size_t index, double uncut_mm) {
  if (!(uncut_mm > 0.0)) return {0.0, 0.0};
  const vision::EntityKerf& kerf = evidence.kerf.entities[index];
  const double blank_mm = std::min(uncut_mm, longestBlank(evidence, kerf, limits).length_mm);
  // How deep what is faint was burnt is judged by ordered_depth, where it is ordered.
  const dieline::Process process = entityOf(evidence, kerf.entity).process;
  const bool ordered = isPartial(process) && orderOf(process, limits) != nullptr;
  return {blank_mm, ordered ? blank_mm : uncut_mm};
}

/// Place of the station that lies nearest to a length along its line.
Eigen::Vector2d stationAt(const vision::EntityKerf& kerf, double station_mm) {
  return std::ranges::min_element(
             kerf.calipers, {}, [&](const vision::Caliper& c) { return std::abs(c.station_mm - station_mm); })
      ->p_S_mm;
}

}  // namespace

Check coverageCheck(const Evidence& evidence, const Tolerances& limits,
                    const std::vector<EntityResult>& entities) {
  Check check{.name = "coverage", .title = "Every line is cut, over its whole length", .unit = "mm"};
  check.value = kNan;
  check.limit = limits.uncut_mm;
  std::size_t judged = 0;
  std::size_t bad = 0;
  std::size_t worst = 0;
  Bounds longest;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const dieline::Process process = entityOf(evidence, entities[i].entity).process;
    if (process == dieline::Process::kPerforation) continue;
    const Bounds uncut = uncutOf(evidence, limits, i, entities[i].uncut_mm);
    if (judged++ == 0 || uncut.isWorseThan(longest, check.limit)) {
      longest = uncut;
      worst = i;
    }
    if (uncut.most_mm > limits.uncut_mm) ++bad;
  }
  if (judged == 0) {
    check.explanation = "The dieline has no continuous line to judge.";
    decide(check);
    return check;
  }
  const vision::EntityKerf& kerf = evidence.kerf.entities[worst];
  const dieline::Entity& entity = entityOf(evidence, kerf.entity);
  check.subject = nameOf(kerf.unit, kerf.entity);
  check.where = onLine(kerf.unit, kerf.entity);
  // Where between two stations a piece begins and ends is known to a quarter of their distance each.
  longest.decideIn(check, pitchOf(kerf));
  const double share = 100.0 * entities[worst].coverage;
  if (check.value == 0.0) {
    check.explanation = fmt::format("All {} entities are burnt over their whole length.", judged);
    return check;
  }
  if (isBlank(entities)) {
    check.explanation =
        evidence.kerf.strays.empty()
            ? "Nothing was cut on any unit, though the printed marks were found."
            : "No line of the dieline was cut on any unit; what was burnt lies elsewhere, see stray.";
    return check;
  }
  const Stretch hole = longest.least_mm < longest.most_mm ? longestUncut(evidence, kerf, limits)
                                                          : longestBlank(evidence, kerf, limits);
  check.where = atPlace(kerf.unit, kerf.entity, stationAt(kerf, hole.from_mm));
  check.explanation = fmt::format(
      "{} of {} entities have an uncut piece of more than {:g} mm; the longest, {:.2f} mm, is on {} ({}, {}) "
      "between station {:.2f} and {:.2f} mm of {:.2f} mm. {:.1f} % of that entity's stations are burnt.",
      bad, judged, limits.uncut_mm, check.value, check.subject, dieline::processName(entity.process),
      entity.origin, hole.from_mm, hole.to_mm, dieline::lengthOf(entity.curve), share);
  if (longest.least_mm < longest.most_mm) {
    check.explanation += fmt::format(
        " A groove can be seen there, but it lets through less than {:.0f} % of the light: it was burnt too "
        "little, or scorch hides it. With {} in the scenario its depth is judged.",
        100.0 * kBurntBrightness,
        entity.process == dieline::Process::kCrease ? "checks.crease_depth" : "checks.half_cut_depth");
  }
  return check;
}

Check strayCheck(const Evidence& evidence, const Tolerances& limits) {
  Check check{.name = "stray", .title = "Nothing is burnt beside the dieline", .unit = "mm"};
  check.limit = limits.stray_mm;
  // Blobs are counted in whole pixels, at both ends.
  check.u = check.guard = evidence.kerf_calibration ? evidence.kerf_calibration->pitchMm() : kNan;
  const vision::StrayCut* worst = nullptr;
  for (const vision::StrayCut& stray : evidence.kerf.strays) {
    if (!std::isfinite(stray.extent_mm)) check.value = kNan;
    if (worst == nullptr || stray.extent_mm > worst->extent_mm) worst = &stray;
  }
  if (worst != nullptr && !std::isnan(check.value)) check.value = worst->extent_mm;
  decide(check);
  if (worst == nullptr) {
    check.explanation = "No burnt spot was found away from the dieline.";
    return check;
  }
  check.subject = fmt::format("unit {}", worst->unit);
  check.where = atPlace(worst->unit, -1, worst->p_S_mm);
  check.explanation =
      fmt::format("Burnt places away from the dieline: {}; the largest is {:.2f} mm long, at {} of unit {}.",
                  evidence.kerf.strays.size(), worst->extent_mm, placeOf(worst->p_S_mm), worst->unit);
  return check;
}

}  // namespace kerfbench::inspect::checks
