// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/kerf.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/compensation/curves.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {
namespace {

using OpenCuts = JobParameters::OpenCuts;

std::vector<int> entitiesOf(const std::vector<Segment>& segments) {
  std::vector<int> entities;
  for (const Segment& segment : segments) entities.push_back(segment.entity);
  return entities;
}

bool areAllIn(const std::set<int>& left_out, const std::vector<int>& entities) {
  return std::ranges::all_of(entities, [&](int entity) { return left_out.contains(entity); });
}

/// Side of a closed cut that is waste: outside of an outline, inside of a hole.
Side wasteSide(const std::vector<Segment>& segments, int nesting) {
  const bool hole = nesting % 2 == 1;
  const bool counter_clockwise = signedAreaMm2(segments) > 0.0;
  return counter_clockwise == hole ? Side::kLeft : Side::kRight;
}

/// Cuts that get a path of their own, and the chains they are.
struct Work {
  std::vector<Contour> contours;
  std::vector<const Chain*> chains;
};

Work workOf(const std::vector<Chain>& chains, const JobParameters& job, const std::set<int>& left_out,
            Compensated& result, std::vector<std::string>& faults) {
  Work work;
  for (const Chain& chain : chains) {
    const bool cut = chain.process == dieline::Process::kCut;
    if (cut && !chain.closed() && areAllIn(left_out, entitiesOf(chain.segments))) continue;
    if (cut && !chain.closed() && job.open_cuts == OpenCuts::kOnTheLine) {
      result.notes.push_back(placeName(entitiesOf(chain.segments), chain.start()) +
                             ": an open cut, the beam runs on its line");
    }
    if (!cut || (!chain.closed() && job.open_cuts == OpenCuts::kOnTheLine)) {
      result.chains.push_back(chain);
      continue;
    }
    Contour contour;
    contour.segments = chain.segments;
    contour.closed = chain.closed();
    contour.side = job.open_cuts == OpenCuts::kRight ? Side::kRight : Side::kLeft;
    try {
      contour = healed(contour, kJoinMm);
    } catch (const CompensationError& error) {
      faults.emplace_back(error.what());
      continue;
    }
    if (contour.closed) {
      if (std::abs(signedAreaMm2(contour.segments)) < kTouchMm) {
        std::vector<std::string> why = contactFaults({contour});
        if (why.empty()) {
          why.push_back(placeName(entitiesOf(chain.segments), chain.start()) +
                        ": a closed cut that encloses nothing");
        }
        faults.insert(faults.end(), why.begin(), why.end());
        continue;
      }
      contour.side = wasteSide(contour.segments, chain.nesting);
    }
    work.contours.push_back(std::move(contour));
    work.chains.push_back(&chain);
  }
  return work;
}

bool isAllowed(const EntityRanges& allowed, const std::vector<int>& entities) {
  return std::ranges::all_of(entities, [&](int entity) { return contains(allowed, entity); });
}

/// Entities as a user types them: "E3,E7".
std::string listOf(const std::vector<int>& entities) {
  std::vector<std::string> names;
  for (const int entity : entities) names.push_back(fmt::format("E{}", entity));
  return fmt::format("{}", fmt::join(names, ","));
}

/// What would let the job go on without the feature.
std::string remedyFor(const LostStretch& lost, const JobParameters& job) {
  const bool by_key = job.given_by == GivenBy::kScenario;
  return fmt::format("{}{} {} cuts the rest", nameOf(Parameter::kAllowLost, job.given_by), by_key ? ":" : "",
                     listOf(lost.entities));
}

/// Entities that may be lost and of which nothing is.
void tellNeedless(const std::vector<LostStretch>& all, const std::vector<Chain>& chains,
                  const JobParameters& job, std::vector<std::string>& notes,
                  std::vector<std::string>& faults) {
  std::set<int> drawn;
  for (const Chain& chain : chains)
    for (const Segment& segment : chain.segments) drawn.insert(segment.entity);
  const std::string name = nameOf(Parameter::kAllowLost, job.given_by);
  for (const auto& range : job.allow_lost) {
    const auto first = drawn.lower_bound(range.first);
    const std::string text = range.first == range.second ? fmt::format("E{}", range.first)
                                                         : fmt::format("E{}-E{}", range.first, range.second);
    if (first == drawn.end() || *first > range.second) {
      faults.push_back(fmt::format("{}: there is no {} in the drawing", name, text));
      continue;
    }
    const bool is_lost = std::ranges::any_of(all, [&](const LostStretch& lost) {
      return lost.kind != LostStretch::Kind::kRounded &&
             std::ranges::any_of(lost.entities, [&](int entity) { return contains({range}, entity); });
    });
    if (!is_lost) notes.push_back(fmt::format("{}: nothing of {} is lost", name, text));
  }
}

std::string sentenceOf(const LostStretch& lost, double radius_mm) {
  const std::string place = placeName(lost.entities, lost.p_mm);
  if (lost.kind == LostStretch::Kind::kWhole) {
    return fmt::format("{}: smaller than the kerf of {:g} mm, there is no path for the beam", place,
                       2.0 * radius_mm);
  }
  return fmt::format("{}: narrower than the kerf of {:g} mm, {:.3f} mm stay uncut over {:.3f} mm of contour",
                     place, 2.0 * radius_mm, lost.depth_mm, lost.length_mm);
}

/// Adds notes on what is lost of entities that are not left out; losses that need consent go to `faults`.
void tell(const std::vector<LostStretch>& all, const JobParameters& job, const std::set<int>& left_out,
          std::vector<std::string>& notes, std::vector<std::string>& faults) {
  int rounded = 0;
  const LostStretch* deepest = nullptr;
  for (const LostStretch& lost : all) {
    if (areAllIn(left_out, lost.entities)) continue;
    if (lost.kind == LostStretch::Kind::kRounded) {
      ++rounded;
      if (deepest == nullptr || lost.depth_mm > deepest->depth_mm) deepest = &lost;
      continue;
    }
    const bool refused = lost.depth_mm > kLostMm && !isAllowed(job.allow_lost, lost.entities);
    std::string sentence = sentenceOf(lost, job.kerf_radius_mm);
    if (refused) sentence += "; " + remedyFor(lost, job);
    (refused ? faults : notes).push_back(std::move(sentence));
  }
  if (deepest != nullptr) {
    notes.push_back(fmt::format("{} inner corner{} rounded by the beam, by {:.3f} mm at most: {}", rounded,
                                rounded == 1 ? "" : "s", deepest->depth_mm,
                                placeName(deepest->entities, deepest->p_mm)));
  }
}

}  // namespace

Compensated compensate(const std::vector<Chain>& chains, const JobParameters& job,
                       const PlannerFaults& planner_faults, const std::set<int>& left_out) {
  Compensated result;
  std::vector<std::string> faults;
  Work work = workOf(chains, job, left_out, result, faults);
  if (planner_faults.kerf_wrong_side) {
    for (Contour& contour : work.contours)
      contour.side = contour.side == Side::kLeft ? Side::kRight : Side::kLeft;
  }
  try {
    result.offset = offsetContours(work.contours, job.kerf_radius_mm);
  } catch (const CompensationError& error) {
    faults.emplace_back(error.what());
  }
  tell(result.offset.lost, job, left_out, result.notes, faults);
  tellNeedless(result.offset.lost, chains, job, result.notes, faults);
  if (!faults.empty()) {
    throw PlanError(fmt::format("kerf compensation by {:g} mm{}:\n{}", job.kerf_radius_mm,
                                left_out.empty() ? "" : " (cuts that are not selected count as well)",
                                fmt::join(faults, "\n")));
  }
  for (const BeamPath& path : result.offset.paths) {
    const Chain& source = *work.chains[path.contour];
    result.chains.push_back({source.process, path.segments, source.nesting});
  }
  result.contours = std::move(work.contours);
  return result;
}

Compensated compensate(const dieline::Dieline& dieline, const JobParameters& job) {
  JobParameters as_drawn = job;
  as_drawn.kerf_radius_mm = 0.0;
  dieline::Dieline whole = dieline;
  for (dieline::Entity& entity : whole.entities) {
    entity.process = dieline::drawnFor(entity);
    entity.left_out.reset();
  }
  return compensate(joinChains(whole, as_drawn, {}), job, {}, leftOut(dieline));
}

}  // namespace kerfbench::planner
