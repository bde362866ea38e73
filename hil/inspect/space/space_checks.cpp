// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/space/space_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace kerfbench::inspect {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string placeOf(const SpaceJob& job, const EdgeReading& reading) {
  const SpaceLine& line = job.lines[reading.line];
  return fmt::format("line {} on {}, {:.2f} mm from its begin", reading.line + 1, job.faces[line.face].name,
                     reading.way_mm);
}

/// Longest stretch along the contour where light comes through and no edge of the kerf can be told.
double longestUnread_mm(const std::vector<EdgeReading>& readings) {
  double longest_mm = 0.0;
  double run_mm = 0.0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const bool goes_on = i > 0 && readings[i - 1].line == readings[i].line;
    const bool unread = readings[i].zone == EdgeZone::kAlong && readings[i].open && !readings[i].found;
    run_mm = unread ? (goes_on ? run_mm : 0.0) + kEdgePitch_mm : 0.0;
    longest_mm = std::max(longest_mm, run_mm);
  }
  return longest_mm;
}

Check pathCheck(const SpaceJob& job, const SpaceResult& result, const SpaceTolerances& limits) {
  Check check{.name = "space_path", .title = "Distance of the edge from the contour in space", .unit = "mm"};
  check.limit = limits.path_mm;
  const WorstDistance& worst = result.worst;
  std::size_t place = worst.reading;
  check.value = worst.value.value;
  check.u = check.guard = worst.value.U;
  if (decide(check) != Verdict::kFail && worst.surest.value - worst.surest.U > check.limit) {
    // Another place is known better, and beyond the limit.
    check.value = worst.surest.value;
    check.u = check.guard = worst.surest.U;
    place = worst.surest_reading;
  } else if (check.verdict == Verdict::kPass) {
    // A place that is known less well may be farther off than the worst as read.
    check.u = check.guard = std::max(check.u, worst.most_mm - check.value);
  }
  if (const double unread_mm = longestUnread_mm(result.readings); unread_mm > limits.uncut_mm) {
    check.value = kNan;
    check.explanation = fmt::format(
        "Along {:.1f} mm of the contour light comes through, but no edge can be told.", unread_mm);
  }
  decide(check);
  if (!check.explanation.empty()) return check;
  if (worst.readings == 0) {
    check.explanation = "No edge was found along the contour away from joints.";
    return check;
  }
  const EdgeReading& at = result.readings[place];
  check.subject = placeOf(job, at);
  check.explanation = fmt::format(
      "Of {} readings the farthest lies {:.4f} mm off: {:.4f} mm {} in the face and {:.4f} mm {} the face as "
      "it "
      "is drawn.",
      worst.readings, at.distance_mm(), std::abs(at.beside_mm),
      at.beside_mm < 0.0 ? "into the piece" : "short of the kerf's side", std::abs(at.above_mm),
      at.above_mm < 0.0 ? "behind" : "before");
  return check;
}

/// The kerf near a fold or a corner at one place: how far it reaches into the piece.
struct Loss {
  double lost_mm{};  ///< < 0: not at all, by so much.
  double U_mm{};
  std::size_t reading{};
};

std::vector<Loss> lossesOf(const std::vector<EdgeReading>& readings) {
  std::vector<Loss> losses;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i].zone != EdgeZone::kJoint || !readings[i].found) continue;
    const MeanReading mean = meanReading(readings, i, 1);
    const double lost_mm = -mean.beside_mm;
    const double U_mm = 2.0 * std::hypot(mean.noise_mm, sharedU_mm(readings[i], {1.0, 0.0}));
    // A kerf that is hardly severed has a width that is hardly known, but it is no wider than its light.
    const double room_mm = readings[i].most_lost_mm - lost_mm;
    losses.push_back({lost_mm, room_mm > 0.0 ? std::min(U_mm, room_mm) : U_mm, i});
  }
  return losses;
}

Check jointsCheck(const SpaceJob& job, const SpaceResult& result, const SpaceTolerances& limits) {
  Check check{
      .name = "space_joints", .title = "Board lost from the piece at folds and corners", .unit = "mm"};
  check.limit = limits.burn_mm;
  const std::vector<Loss> losses = lossesOf(result.readings);
  if (losses.empty()) {
    check.value = kNan;
    check.explanation = "No kerf was found near folds and corners.";
    decide(check);
    return check;
  }
  // Each place has its own U: the one that proves a loss, or else the one that leaves most of it open.
  const auto take = [&](const Loss& loss) {
    check.value = loss.lost_mm;
    check.u = check.guard = loss.U_mm;
    check.subject = placeOf(job, result.readings[loss.reading]);
    return decide(check);
  };
  const auto surely = [](const Loss& loss) { return loss.lost_mm - loss.U_mm; };
  const auto perhaps = [](const Loss& loss) { return loss.lost_mm + loss.U_mm; };
  if (take(*std::ranges::max_element(losses, {}, surely)) != Verdict::kFail)
    take(*std::ranges::max_element(losses, {}, perhaps));
  check.explanation = fmt::format(
      "Of {} readings near folds and corners, the kerf reaches farthest into the piece here (< 0: it "
      "stays off it).",
      losses.size());
  return check;
}

Check coverageCheck(const SpaceJob& job, const SpaceResult& result, const SpaceTolerances& limits) {
  Check check{
      .name = "space_coverage", .title = "Longest stretch of the contour not cut through", .unit = "mm"};
  check.limit = limits.uncut_mm;
  check.value = result.readings.empty() ? kNan : 0.0;
  double run_mm = 0.0;
  for (std::size_t i = 0; i < result.readings.size(); ++i) {
    const EdgeReading& reading = result.readings[i];
    const bool goes_on = i > 0 && result.readings[i - 1].line == reading.line;
    if (!goes_on) run_mm = 0.0;
    run_mm = reading.open || !reading.strict ? 0.0 : run_mm + kEdgePitch_mm;
    if (run_mm <= check.value) continue;
    check.value = run_mm;
    check.subject = placeOf(job, reading);
  }
  check.u = check.guard = check.value > 0.0 ? 0.5 * kEdgePitch_mm : 0.0;
  decide(check);
  check.explanation =
      fmt::format("Of {} places along the contour, {:.1f} mm apart.", result.readings.size(), kEdgePitch_mm);
  return check;
}

/// Distance from a line's end at a fold within which the joint may lead the beam: to where the offset leaves
/// the face, in whichever of both faces that is farther, and a kerf and a half beyond.
double jointReach_mm(const SpaceJob& job, std::size_t index, bool at_begin) {
  const auto out_mm = [&](const SpaceLine& line, bool begin) {
    const double beyond_mm = begin ? line.kerf_from_mm : line.kerf_to_mm - line.length_mm;
    return std::hypot(job.kerf_radius_mm, beyond_mm);
  };
  const SpaceLine& other = job.lines[at_begin ? index - 1 : index + 1];
  return std::max(out_mm(job.lines[index], at_begin), out_mm(other, !at_begin)) + 3.0 * job.kerf_radius_mm;
}

/// Whether a burnt place is part of the kerf round a fold: near it, and beside the contour where the kerf is
/// to lie.
bool isOfJoint(const SpaceJob& job, std::size_t face, const Eigen::Vector2d& p_F_mm) {
  for (std::size_t i = 0; i < job.lines.size(); ++i) {
    const SpaceLine& line = job.lines[i];
    if (line.face != face || (p_F_mm - line.from_F_mm).dot(line.beside_F) <= 0.0) continue;
    if (line.begin == LineEndKind::kFold && (p_F_mm - line.from_F_mm).norm() < jointReach_mm(job, i, true))
      return true;
    if (line.end == LineEndKind::kFold && (p_F_mm - line.to_F_mm).norm() < jointReach_mm(job, i, false))
      return true;
  }
  return false;
}

Check strayCheck(const SpaceJob& job, const std::vector<FaceEvidence>& faces, const SpaceTolerances& limits) {
  Check check{.name = "space_stray", .title = "Longest burnt place away from the kerf", .unit = "mm"};
  check.limit = limits.stray_mm;
  int count = 0;
  for (std::size_t face = 0; face < faces.size(); ++face) {
    for (const vision::StrayCut& stray : faces[face].scan.strays) {
      if (!job.faces[face].outline_F_mm.contains(stray.p_S_mm) || isOfJoint(job, face, stray.p_S_mm))
        continue;
      ++count;
      if (stray.extent_mm <= check.value) continue;
      check.value = stray.extent_mm;
      check.subject =
          fmt::format("{}, ({:.2f}, {:.2f}) mm", job.faces[face].name, stray.p_S_mm.x(), stray.p_S_mm.y());
    }
  }
  decide(check);
  check.explanation = fmt::format("{} burnt places were found off the kerf.", count);
  return check;
}

/// What keeps the evidence from being trusted.
std::vector<std::string> problemsOf(const SpaceJob& job, const std::vector<FaceEvidence>& faces) {
  std::vector<std::string> problems;
  for (std::size_t face = 0; face < job.faces.size(); ++face) {
    for (const std::string& problem : faces[face].scan.problems)
      problems.push_back(fmt::format("face {}: {}", job.faces[face].name, problem));
    if (faces[face].scan.units.empty())
      problems.push_back(fmt::format("face {}: no picture tells where its kerf lies", job.faces[face].name));
    const bool has_lines =
        std::ranges::any_of(job.lines, [&](const SpaceLine& line) { return line.face == face; });
    if (has_lines && !faces[face].pose)
      problems.push_back(fmt::format("face {}: nothing tells how it stood", job.faces[face].name));
  }
  return problems;
}

}  // namespace

SpaceResult judgeInSpace(const SpaceJob& job, const std::vector<ContourPoint>& contour,
                         const std::vector<FaceEvidence>& faces, const SpaceInstruments& instruments,
                         const SpaceTolerances& limits, std::uint64_t seed) {
  SpaceResult result;
  result.problems = problemsOf(job, faces);
  result.readings = readEdges(job, faces, contour, instruments);
  result.worst = worstDistance(result.readings, seed);
  result.checks.push_back(pathCheck(job, result, limits));
  const bool has_joints =
      std::ranges::any_of(job.lines, [](const SpaceLine& line) { return line.end != LineEndKind::kFree; });
  if (has_joints) result.checks.push_back(jointsCheck(job, result, limits));
  result.checks.push_back(coverageCheck(job, result, limits));
  result.checks.push_back(strayCheck(job, faces, limits));
  for (Check& check : result.checks) {
    if (const std::string risk = riskSentence(check); !risk.empty()) check.explanation += " " + risk;
  }
  result.verdict = combine(result.checks, result.problems.empty());
  return result;
}

}  // namespace kerfbench::inspect
