// SPDX-License-Identifier: Apache-2.0
// Did every frame that matters arrive, and with the time at which it was taken?
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "hil/inspect/checks/spot_checks.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr double kFewestFrames = 3;
/// A stamp that lies farther from where the frame's number puts it, as a share of the time between frames, is
/// wrong; a good one jitters by less.
constexpr double kStampShare = 0.5;
/// How far the sheet may lie from where the frames before and after have it: what a mark may be misread by,
/// and a belt that speeds up.
constexpr double kSheetJump_mm = 0.1;
constexpr double kBelt_mm_s2 = 1000.0;
constexpr double kMaxPoseGap_s = 0.25;

using Frames = std::vector<vision::FrameMeasurement>;

bool inOrder(const vision::FrameMeasurement& a, const vision::FrameMeasurement& b) {
  return b.sequence > a.sequence && b.mid_s > a.mid_s;
}

double periodOf(const Frames& frames) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (!inOrder(frames[i - 1], frames[i])) continue;
    periods.push_back((frames[i].mid_s - frames[i - 1].mid_s) /
                      static_cast<double>(frames[i].sequence - frames[i - 1].sequence));
  }
  return medianOf(std::move(periods));
}

bool gateOpenWithin(const std::vector<GateInterval>& gates, double begin_s, double end_s) {
  return std::any_of(gates.begin(), gates.end(),
                     [&](const GateInterval& g) { return g.on_s < end_s && g.off_s > begin_s; });
}

void tellStamps(const Frames& frames, double period_s, std::vector<std::string>& problems) {
  std::size_t wrong = 0;
  std::uint64_t first = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (!(frames[i].sequence > frames[i - 1].sequence)) continue;
    const double expected_s = period_s * static_cast<double>(frames[i].sequence - frames[i - 1].sequence);
    if (std::abs(frames[i].mid_s - frames[i - 1].mid_s - expected_s) <= kStampShare * period_s) continue;
    if (wrong++ == 0) first = frames[i].sequence;
  }
  if (wrong == 0) return;
  problems.push_back(
      fmt::format("{} times the spot camera's time stamps do not fit the numbers of its frames, first at "
                  "number {}: stamps are "
                  "wrong, or the camera was not ready in time.",
                  wrong, first));
}

struct TimedPose {
  const vision::FrameMeasurement* frame;
  const vision::SheetPose* pose;
};

/// A frame whose picture or stamp is another's shows the sheet at a place where it cannot have been then.
void tellSheet(const Frames& frames, std::vector<std::string>& problems) {
  std::map<int, std::vector<TimedPose>> tracks;
  for (const vision::FrameMeasurement& frame : frames) {
    for (const vision::SheetPose& pose : frame.sheet) tracks[pose.unit].push_back({&frame, &pose});
  }
  std::size_t wrong = 0;
  std::uint64_t first = 0;
  double farthest_mm = 0.0;
  for (const auto& [unit, track] : tracks) {
    for (std::size_t i = 1; i + 1 < track.size(); ++i) {
      const TimedPose& a = track[i - 1];
      const TimedPose& b = track[i];
      const TimedPose& c = track[i + 1];
      const double before_s = b.frame->mid_s - a.frame->mid_s;
      const double after_s = c.frame->mid_s - b.frame->mid_s;
      if (!(before_s > 0.0) || !(after_s > 0.0) || before_s + after_s > kMaxPoseGap_s) continue;
      const double share = before_s / (before_s + after_s);
      const double off_mm =
          b.pose->p_WS_mm.x() - (1.0 - share) * a.pose->p_WS_mm.x() - share * c.pose->p_WS_mm.x();
      const double variance = b.pose->covariance(0, 0) + a.pose->covariance(0, 0) + c.pose->covariance(0, 0);
      const double allowed_mm =
          kSheetJump_mm + 6.0 * std::sqrt(std::max(variance, 0.0)) + 0.5 * kBelt_mm_s2 * before_s * after_s;
      if (std::abs(off_mm) <= allowed_mm) continue;
      if (wrong++ == 0) first = b.frame->sequence;
      farthest_mm = std::max(farthest_mm, std::abs(off_mm));
    }
  }
  if (wrong == 0) return;
  problems.push_back(
      fmt::format("{} times the sheet does not lie where the frames before and after have it, by up to "
                  "{:.2f} mm, first in frame {}: a time stamp is wrong, or a mark was taken for another.",
                  wrong, farthest_mm, first));
}

/// The camera must watch from the first cut to the last.
void tellCoverage(const Evidence& evidence, double period_s, std::vector<std::string>& problems) {
  if (evidence.gates.empty()) return;
  const Frames& frames = evidence.spot.frames;
  double begin_s = evidence.gates.front().on_s;
  double end_s = evidence.gates.front().off_s;
  for (const GateInterval& gate : evidence.gates) {
    begin_s = std::min(begin_s, gate.on_s);
    end_s = std::max(end_s, gate.off_s);
  }
  if (frames.front().mid_s > begin_s + period_s)
    problems.emplace_back("The spot camera's frames begin after the first cut.");
  if (frames.back().mid_s < end_s - period_s)
    problems.emplace_back("The spot camera's frames end before the last cut.");
}

}  // namespace

FrameLosses lossesOf(const Evidence& evidence) {
  const Frames& frames = evidence.spot.frames;
  FrameLosses losses;
  const double period_s = periodOf(frames);
  std::uint64_t told = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const vision::FrameMeasurement& a = frames[i - 1];
    const vision::FrameMeasurement& b = frames[i];
    if (!(b.sequence > a.sequence)) {
      ++losses.out_of_order;
      ++told;
      continue;
    }
    const std::uint64_t lost = b.sequence - a.sequence - 1;
    told += lost;
    if (lost == 0) continue;
    // The frame next to a cut is part of it: it tells that the laser came on late, or stayed on. Which frame
    // of the gap that was is not known.
    const bool harmful =
        !std::isfinite(period_s) || gateOpenWithin(evidence.gates, a.mid_s - period_s, b.mid_s + period_s);
    (harmful ? losses.around_cuts : losses.between_cuts) += lost;
    if (harmful && losses.around_cuts == lost) losses.first = a.sequence + 1;
  }
  if (evidence.spot.frames_lost > told) losses.around_cuts += evidence.spot.frames_lost - told;
  return losses;
}

std::vector<std::string> frameProblems(const Evidence& evidence) {
  std::vector<std::string> problems;
  const Frames& frames = evidence.spot.frames;
  if (frames.empty()) return {"The spot camera gave no frame."};
  const FrameLosses losses = lossesOf(evidence);
  if (losses.around_cuts > 0) {
    problems.push_back(fmt::format("The spot camera lost {} frames around cuts, the first is number {}.",
                                   losses.around_cuts, losses.first));
  }
  if (losses.out_of_order > 0) {
    problems.push_back(
        fmt::format("{} frames of the spot camera came out of order, or twice.", losses.out_of_order));
  }
  const double period_s = periodOf(frames);
  if (static_cast<double>(frames.size()) < kFewestFrames || !std::isfinite(period_s)) {
    problems.emplace_back("The spot camera gave too few frames to tell how often it takes one.");
    return problems;
  }
  tellStamps(frames, period_s, problems);
  tellSheet(frames, problems);
  tellCoverage(evidence, period_s, problems);
  return problems;
}

}  // namespace kerfbench::inspect::checks
