// SPDX-License-Identifier: Apache-2.0
// Frames taken while the laser's gate was open that show no spot.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/evidence/emitted_light.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// Time around a switch of the gate in which a dark frame is excused: power is proportional to speed, and
/// where the beam sets off and stops it glows too little to be seen.
constexpr double kRamp_s = 0.02;
/// Share of the usual speed, and of the light that the pins usually let out during an exposure, below which a
/// dark frame is excused: in corners, on the ramps of heavy heads (82 ms on strip-stop-and-go), and where
/// marks of little power get a pulse of light now and then.
constexpr double kSlowShare = 0.6;
/// Factor of the usual uncertainty of a spot beyond which a neighbouring frame is so faint that a dark one is
/// excused. On carton-on-belt, whose creases take half the power, one is dark at 0.7 of the speed next to one
/// of 2.5 times; at full speed those creases are at 1.7 times.
constexpr double kFaintSpot = 2.0;
/// Whether a faint spot is found is a matter of noise: so many of all frames may be dark without an excuse,
/// but never two in a row.
constexpr double kDarkShare = 0.001;

/// Periods of the camera before and behind a frame within which the pins must let light out, for a frame
/// between two pulses of it to be excused: a gate that is open without any light is not.
constexpr double kPulsePeriods = 3.0;

/// The laser's light may lag so far behind its pins, and by the same time all through a run: an RF-excited
/// CO2 tube takes 50 to 100 us to emit. Of two pulses at the borders of an exposure the lag decides which is
/// seen.
constexpr double kLongestLag_s = 300e-6;
constexpr double kLagStep_s = 10e-6;

/// What most frames show.
struct Usual {
  double speed_mm_s{};
  double sigma_mm{};
};

/// For how long the pins let the laser emit during a frame, or about it by as much as its time is uncertain;
/// its light comes lag_s later.
double lightIn(const EmittedLight& light, const vision::FrameMeasurement& f, double uncertain_s,
               double lag_s) {
  const double half_s = 0.5 * f.exposure_s + uncertain_s;
  return light.between(f.mid_s - lag_s - half_s, f.mid_s - lag_s + half_s);
}

/// Light in most of the frames that show the spot. A lag that leaves none of it is not the laser's.
double usualLight_s(const Evidence& evidence, const LitFrames& lit, const EmittedLight& light, double lag_s) {
  std::vector<double> lights;
  for (const LitFrame& f : lit.frames) {
    const vision::FrameMeasurement& frame = evidence.spot.frames[f.frame];
    if (frame.exposure_s > 0.0) lights.push_back(lightIn(light, frame, 0.0, lag_s));
  }
  return lights.empty() ? 0.0 : medianOf(std::move(lights));
}

Usual usualOf(const Evidence& evidence, const LitFrames& lit) {
  std::vector<double> speeds;
  std::vector<double> sigmas;
  for (const LitFrame& f : lit.frames) sigmas.push_back(evidence.spot.frames[f.frame].spot_sigma_mm);
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      const LitFrame& a = lit.frames[i - 1];
      const LitFrame& b = lit.frames[i];
      if (b.time_s > a.time_s) speeds.push_back((b.p_S_mm - a.p_S_mm).norm() / (b.time_s - a.time_s));
    }
  }
  return {medianOf(std::move(speeds)), medianOf(std::move(sigmas))};
}

/// Whether the beam is slow at an end of its cut, where only one frame beside the dark one shows it: by the
/// way from there to the end of its line, which is where the gate switches. `further` is the next lit frame
/// away from that end, and tells which it is. Only for a single dark frame: beyond, it may be on another
/// line.
bool isSlowToEnd(const Evidence& evidence, const LitFrames& lit, const LitFrame& beside,
                 const LitFrame& further, double switch_s, const Usual& usual) {
  const double time_s = std::abs(switch_s - beside.time_s);
  if (beside.entity < 0 || further.entity != beside.entity || further.unit != beside.unit ||
      !(time_s <= 2.0 * lit.period_s))
    return false;
  const dieline::Curve& curve = evidence.dieline->entities[static_cast<std::size_t>(beside.entity)].curve;
  const double u = dieline::nearestOn(curve, beside.p_S_mm).u;
  const double end = u > dieline::nearestOn(curve, further.p_S_mm).u ? 1.0 : 0.0;
  return std::abs(end - u) * dieline::lengthOf(curve) < kSlowShare * usual.speed_mm_s * time_s;
}

/// Nothing excuses that the frame taken at time_s within the gate is dark.
bool isBlind(const Evidence& evidence, const LitFrames& lit, const GateInterval& gate, double time_s,
             const Usual& usual) {
  if (time_s < gate.on_s + kRamp_s || time_s > gate.off_s - kRamp_s) return false;
  const auto after = std::lower_bound(lit.frames.begin(), lit.frames.end(), time_s,
                                      [](const LitFrame& f, double t) { return f.time_s < t; });
  const auto within = [&](std::ptrdiff_t offset) {
    const std::ptrdiff_t i = after - lit.frames.begin() + offset;
    return i >= 0 && i < std::ssize(lit.frames) && (after + offset)->time_s >= gate.on_s &&
           (after + offset)->time_s <= gate.off_s;
  };
  if (!within(0) && within(-1) && within(-2))
    return !isSlowToEnd(evidence, lit, *(after - 1), *(after - 2), gate.off_s, usual);
  if (!within(-1) && within(0) && within(1))
    return !isSlowToEnd(evidence, lit, *after, *(after + 1), gate.on_s, usual);
  if (!within(-1) || !within(0)) return true;
  const LitFrame& before = *(after - 1);
  if (before.unit != after->unit) return true;
  const auto isFaint = [&](const LitFrame& f) {
    return evidence.spot.frames[f.frame].spot_sigma_mm > kFaintSpot * usual.sigma_mm;
  };
  if (isFaint(before) || isFaint(*after)) return false;
  const double speed_mm_s = (after->p_S_mm - before.p_S_mm).norm() / (after->time_s - before.time_s);
  return !(speed_mm_s < kSlowShare * usual.speed_mm_s);
}

/// Frames taken with the gate open, and those of them in which nothing but a gap in the light of the pins may
/// excuse that there is no spot.
struct OpenFrames {
  std::size_t count{};
  struct Dark {
    const vision::FrameMeasurement* frame{};
    std::size_t place{};  ///< Number among all frames taken with the gate open.
  };
  std::vector<Dark> dark;
};

OpenFrames openFrames(const Evidence& evidence, const LitFrames& lit, const Usual& usual) {
  std::vector<GateInterval> gates = evidence.gates;
  std::ranges::sort(gates, {}, &GateInterval::on_s);
  OpenFrames open;
  for (const vision::FrameMeasurement& frame : evidence.spot.frames) {
    const auto next = std::ranges::upper_bound(gates, frame.mid_s, {}, &GateInterval::on_s);
    if (next == gates.begin() || frame.mid_s > (next - 1)->off_s) continue;
    if (!frame.spot_W_mm && isBlind(evidence, lit, *(next - 1), frame.mid_s, usual))
      open.dark.push_back({&frame, open.count});
    ++open.count;
  }
  return open;
}

/// Dark frames that nothing excuses.
struct BlindFrames {
  std::size_t count{};
  bool in_a_row{};
  double first_s{};
};

/// Frames that are dark though the laser's light, if it comes lag_s behind the pins, falls into them.
BlindFrames blindFrames(const Evidence& evidence, const LitFrames& lit, const EmittedLight& light,
                        const OpenFrames& open, double lag_s) {
  const double near_s = kPulsePeriods * lit.period_s;
  const double usual_s = usualLight_s(evidence, lit, light, lag_s);
  const auto isBetweenPulses = [&](const vision::FrameMeasurement& frame) {
    return lightIn(light, frame, evidence.clock_bound_s, lag_s) < kSlowShare * usual_s &&
           light.between(frame.mid_s - near_s, frame.mid_s) > 0.0 &&
           light.between(frame.mid_s, frame.mid_s + near_s) > 0.0;
  };
  BlindFrames blind;
  std::optional<std::size_t> last;
  for (const OpenFrames::Dark& dark : open.dark) {
    if (isBetweenPulses(*dark.frame)) continue;
    if (blind.count++ == 0) blind.first_s = dark.frame->mid_s;
    blind.in_a_row = blind.in_a_row || last == dark.place - 1;
    last = dark.place;
  }
  return blind;
}

/// The same by the lag that explains the most. A laser that is dead where the pins ask for light is explained
/// by none.
BlindFrames blindFrames(const Evidence& evidence, const LitFrames& lit, const EmittedLight& light,
                        const OpenFrames& open) {
  BlindFrames fewest = blindFrames(evidence, lit, light, open, 0.0);
  for (int i = 1; i * kLagStep_s <= kLongestLag_s && fewest.count > 0; ++i) {
    const BlindFrames with_lag = blindFrames(evidence, lit, light, open, i * kLagStep_s);
    if (with_lag.count < fewest.count) fewest = with_lag;
  }
  return fewest;
}

}  // namespace

Check spotSeenCheck(const Evidence& evidence, const LitFrames& lit) {
  Check check{
      .name = "spot_seen", .title = "The spot is seen while the laser's gate is open", .unit = "share"};
  check.value = std::numeric_limits<double>::quiet_NaN();
  const EmittedLight light(evidence.light);
  const OpenFrames open = openFrames(evidence, lit, usualOf(evidence, lit));
  const BlindFrames blind = blindFrames(evidence, lit, light, open);
  check.limit = kDarkShare;
  if (blind.count > 0) check.where = atTime(blind.first_s);
  if (open.count > 0) check.value = static_cast<double>(blind.count) / static_cast<double>(open.count);
  decide(check);
  const FrameLosses losses = lossesOf(evidence);
  const std::string lost =
      losses.between_cuts == 0
          ? ""
          : fmt::format(" {} frames were lost between cuts, where they are not needed.", losses.between_cuts);
  if (open.count == 0) {
    check.explanation = "No frame was taken while the gate was open." + lost;
  } else if (blind.count == 0) {
    check.explanation = fmt::format(
        "Of {} frames taken with the gate open none is dark but where the beam is weak.{}", open.count, lost);
  } else if (check.verdict == Verdict::kPass && !blind.in_a_row) {
    check.explanation = fmt::format(
        "In {} of {} frames taken with the gate open there is no spot, first at {:.3f} s, each time in one "
        "frame "
        "between others that show it.{}",
        blind.count, open.count, blind.first_s, lost);
  } else {
    // Laser or camera: this alone does not tell. If nothing was cut there, the coverage fails.
    check.verdict = Verdict::kInvalid;
    check.explanation = fmt::format(
        "In {} of {} frames taken with the gate open there is no spot though the beam is not weak, first at "
        "{:.3f} s: what it did there was not seen.{}",
        blind.count, open.count, blind.first_s, lost);
  }
  return check;
}

}  // namespace kerfbench::inspect::checks
