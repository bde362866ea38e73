// SPDX-License-Identifier: Apache-2.0
// Is each line cut once? The spot's way along it tells. A line on which too few frames fall is counted
// together with those that go on from it: an outline drawn as short pieces has no other.
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/outlines.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr double kMinExpectedFrames = 4.0;
/// The same for short lines together: the beam does not stop where they meet, so that a frame at either end
/// may be counted for the next line.
constexpr double kMinExpectedFramesOfSeveral = 8.0;

/// A line, or several that follow each other, and how often the spot went along them.
struct Followed {
  int unit{};
  int first{};
  int last{};
  std::size_t lines{};
  double length_mm{};
  double swept_mm{};

  void add(const EntityResult& e, double entity_mm) {
    if (lines++ == 0) first = e.entity;
    unit = e.unit;
    last = e.entity;
    length_mm += entity_mm;
    swept_mm += e.passes * entity_mm;
  }
  void add(const Followed& other) {
    last = other.last;
    lines += other.lines;
    length_mm += other.length_mm;
    swept_mm += other.swept_mm;
  }
};

std::string nameOf(const Followed& followed) {
  std::string name = checks::nameOf(followed.unit, followed.first);
  if (followed.lines > 1) name += fmt::format(" to E{}", followed.last);
  return name;
}

double lengthIn(const Evidence& evidence, int entity) {
  return dieline::lengthOf(evidence.dieline->entities[static_cast<std::size_t>(entity)].curve);
}

/// Ways of the drawing, in order, of lines that may be counted together. The teeth of a perforation are not:
/// the spot is dark between them.
std::vector<std::vector<int>> waysOf(const dieline::Dieline& dieline) {
  std::vector<std::vector<int>> ways;
  const auto add = [&](const std::vector<dieline::OutlineStep>& steps) {
    std::vector<int>& way = ways.emplace_back();
    for (const dieline::OutlineStep& step : steps) way.push_back(step.entity);
  };
  for (const auto process : {dieline::Process::kCut, dieline::Process::kHalfCut, dieline::Process::kCrease}) {
    const dieline::Outlines outlines = dieline::outlinesOf(dieline, process);
    for (const dieline::Outline& outline : outlines.closed) add(outline.steps);
    for (const auto& steps : outlines.open) add(steps);
  }
  return ways;
}

/// Adds the short lines of one stretch without a long one, in pieces that are long enough; what is left at
/// the end is part of the last.
void addShort(const std::vector<std::pair<const EntityResult*, double>>& stretch, double step_mm,
              std::vector<Followed>& all) {
  std::vector<Followed> pieces(1);
  for (const auto& [e, length_mm] : stretch) {
    pieces.back().add(*e, length_mm);
    if (pieces.back().length_mm >= kMinExpectedFramesOfSeveral * step_mm) pieces.emplace_back();
  }
  if (pieces.size() > 1) {
    if (pieces.back().lines > 0) pieces[pieces.size() - 2].add(pieces.back());
    pieces.pop_back();
  }
  for (const Followed& piece : pieces)
    if (piece.length_mm >= kMinExpectedFrames * step_mm) all.push_back(piece);
}

/// All that the camera can count, given its usual step from frame to frame.
std::vector<Followed> followedOf(const Evidence& evidence, const std::vector<EntityResult>& entities,
                                 double step_mm) {
  std::vector<Followed> all;
  std::map<int, std::map<int, const EntityResult*>> shorter;  // Keys are unit and entity.
  for (const EntityResult& e : entities) {
    const double length_mm = lengthIn(evidence, e.entity);
    if (length_mm >= kMinExpectedFrames * step_mm)
      all.emplace_back().add(e, length_mm);
    else if (step_mm > 0.0)
      shorter[e.unit][e.entity] = &e;
  }
  if (shorter.empty()) return all;
  const auto ways = waysOf(*evidence.dieline);
  for (const auto& [unit, by_entity] : shorter) {
    for (const std::vector<int>& way : ways) {
      std::vector<std::pair<const EntityResult*, double>> stretch;
      for (const int entity : way) {
        const auto found = by_entity.find(entity);
        if (found != by_entity.end()) {
          stretch.emplace_back(found->second, lengthIn(evidence, entity));
          continue;
        }
        addShort(stretch, step_mm, all);
        stretch.clear();
      }
      addShort(stretch, step_mm, all);
    }
  }
  return all;
}

}  // namespace

Check repeatCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit,
                  const std::vector<EntityResult>& entities) {
  Check check{.name = "repeat", .title = "No line is cut twice"};
  check.limit = limits.passes;
  check.value = kNan;
  std::vector<double> steps_mm;
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      steps_mm.push_back((lit.frames[i].p_S_mm - lit.frames[i - 1].p_S_mm).norm());
    }
  }
  const double step_mm = medianOf(std::move(steps_mm));
  std::size_t judged = 0;
  for (const Followed& followed : followedOf(evidence, entities, step_mm)) {
    judged += followed.lines;
    const double passes = followed.swept_mm / followed.length_mm;
    if (!std::isnan(check.value) && passes <= check.value) continue;
    check.value = passes;
    check.u = check.guard = std::min(step_mm / followed.length_mm, 0.25);
    check.subject = nameOf(followed);
    check.where = onLine(followed.unit, followed.first);
  }
  decide(check);
  if (judged == 0) {
    check.explanation = "The spot camera saw no line long enough to count how often it was cut.";
    return check;
  }
  check.explanation =
      check.verdict == Verdict::kPass
          ? fmt::format("None of {} lines was followed more than once; the most is {:.2f} times, {}.", judged,
                        check.value, check.subject)
          : fmt::format("The spot went along {} {:.2f} times: it was cut more than once, at least in part.",
                        check.subject, check.value);
  if (judged < entities.size()) {
    check.explanation += fmt::format(
        " {} lines are too short for the camera to count; their kerf width tells.", entities.size() - judged);
  }
  return check;
}

}  // namespace kerfbench::inspect::checks
