// SPDX-License-Identifier: Apache-2.0
// Whether corners, line ends and closures lie where the dieline has them.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect::checks {
namespace {

/// Less of an entity than that: it is not there, which is a matter of coverage.
constexpr double kCut = 0.5;

enum class JointState { kYes, kNotThere, kNotAlike, kShortLeg };

/// What of a joint is a deviation from the dieline. Rounding and overshoot tell the reason for one.
bool isDeviation(JointResult::Kind kind) {
  return kind != JointResult::Kind::kRounding && kind != JointResult::Kind::kOvershoot;
}

/// Corners of two processes, or with a perforation, which may have a bridge there: a look at the outline of
/// one kerf does not tell of them.
JointState judgedOf(const Evidence& evidence, const JointResult& joint,
                    const std::vector<EntityResult>& entities) {
  const auto processOf = [&](int id) {
    return evidence.dieline->entities[static_cast<std::size_t>(id)].process;
  };
  const dieline::Process process = processOf(joint.entity);
  if (process == dieline::Process::kPerforation || process != processOf(joint.entity_out))
    return JointState::kNotAlike;
  for (const EntityResult& e : entities) {
    const bool own = e.unit == joint.unit && (e.entity == joint.entity || e.entity == joint.entity_out);
    if (own && e.coverage < kCut) return JointState::kNotThere;
  }
  return joint.short_leg ? JointState::kShortLeg : JointState::kYes;
}

std::string jointOf(const JointResult& j) {
  const std::string place = placeOf(j.p_S_mm);
  if (j.kind == JointResult::Kind::kCorner)
    return j.entity == j.entity_out ? fmt::format("corner at {}", place)
                                    : fmt::format("corner to E{} at {}", j.entity_out, place);
  if (j.kind == JointResult::Kind::kClosure) return fmt::format("closure at {}", place);
  return fmt::format("{} at {}", j.at_start ? "start" : "end", place);
}

std::string storyOf(const JointResult& j, const std::vector<JointResult>& joints) {
  if (j.kind == JointResult::Kind::kClosure)
    return fmt::format("between its start and its end {:.4f} mm are left uncut", j.mm.value);
  if (j.kind == JointResult::Kind::kEndGap)
    return fmt::format("the kerf ends {:.4f} mm {}", std::abs(j.mm.value),
                       j.mm.value > 0.0 ? "too early" : "too late");
  std::string story = fmt::format("the cut lies {:.4f} mm off the dieline", j.mm.value);
  for (const JointResult& r : joints) {
    const bool same = r.unit == j.unit && r.entity == j.entity && r.entity_out == j.entity_out &&
                      r.p_S_mm == j.p_S_mm && !isDeviation(r.kind);
    if (!same || !(r.mm.value > r.mm.U)) continue;
    story += fmt::format(", {} by {:.4f} mm against its own legs",
                         r.kind == JointResult::Kind::kRounding ? "rounded off" : "run over", r.mm.value);
  }
  return story;
}

/// Joints by what can be said of them.
struct SortedJoints {
  std::vector<const JointResult*> judged;
  std::vector<const JointResult*> unseen;
  std::vector<const JointResult*> short_legs;
  std::size_t unlike{};
};

SortedJoints sorted(const Evidence& evidence, const std::vector<JointResult>& joints,
                    const std::vector<EntityResult>& entities) {
  SortedJoints s;
  for (const JointResult& j : joints) {
    if (!isDeviation(j.kind)) continue;
    const JointState decision = judgedOf(evidence, j, entities);
    if (decision == JointState::kNotAlike) ++s.unlike;
    if (decision == JointState::kShortLeg) s.short_legs.push_back(&j);
    if (decision == JointState::kYes)
      (std::isfinite(j.mm.value) && std::isfinite(j.mm.U) ? s.judged : s.unseen).push_back(&j);
  }
  return s;
}

/// Corners that are not judged, and why; empty if all are.
std::string notJudgedStory(const SortedJoints& s) {
  std::string story;
  if (s.unlike > 0)
    story += fmt::format(" {} corners of two processes or of a perforation are not judged.", s.unlike);
  if (!s.short_legs.empty()) {
    const JointResult& first = *s.short_legs.front();
    story += fmt::format(" {} with a leg too short to be read are not judged; the first is the {} of {}.",
                         s.short_legs.size(), jointOf(first), nameOf(first.unit, first.entity));
  }
  return story;
}

}  // namespace

Finding jointsCheck(const Evidence& evidence, const Tolerances& limits,
                    const std::vector<JointResult>& joints, const std::vector<EntityResult>& entities) {
  Check check{.name = "joints", .title = "Corners, line ends and closures lie on the dieline", .unit = "mm"};
  check.limit = limits.path_mm;
  const SortedJoints s = sorted(evidence, joints, entities);
  const std::string others = notJudgedStory(s);
  if (s.judged.empty() && s.unseen.empty()) {
    if (others.empty())
      return notApplicable(check,
                           "Nothing of the dieline that was cut has a corner, a free end or a closure.");
    return notJudged(check, "No joint can be judged." + others);
  }
  ExtremeEstimate extreme(s.judged.size());
  const JointResult* worst = nullptr;
  double none_beyond = 1.0;
  const auto most = [](const JointResult& j) { return std::abs(j.mm.value) + j.mm.U; };
  for (const JointResult* j : s.judged) {
    extreme.add(j->mm.value, 0.5 * j->mm.U);
    none_beyond *= 1.0 - chanceAboveNormal(check.limit, {std::abs(j->mm.value), j->mm.U});
    if (worst == nullptr || most(*j) > most(*worst)) worst = j;
  }
  check.value = s.unseen.empty() ? extreme.value() : std::numeric_limits<double>::quiet_NaN();
  check.u = check.guard = extreme.expandedU();
  check.chance_beyond = 1.0 - none_beyond;
  decide(check);
  const JointResult& named = s.unseen.empty() ? *worst : *s.unseen.front();
  check.subject = nameOf(named.unit, named.entity);
  check.where = atPlace(named.unit, named.entity, named.p_S_mm);
  if (!s.unseen.empty()) {
    check.explanation =
        fmt::format("{} of {} joints could not be measured; the first is the {} of {}.", s.unseen.size(),
                    s.unseen.size() + s.judged.size(), jointOf(named), check.subject);
  } else {
    check.explanation =
        fmt::format("Of {} corners, ends and closures the worst is the {} of {}: {}; its own U is {:.4f} mm.",
                    s.judged.size(), jointOf(named), check.subject, storyOf(named, joints), named.mm.U);
  }
  check.explanation += others;
  return check;
}

}  // namespace kerfbench::inspect::checks
