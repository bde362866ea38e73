// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/light_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace kerfbench::camera {
namespace {

/// Begins of light that are tried against each interval: the first may be a reflex, or an interval's second
/// half.
constexpr std::size_t kTriedBegins = 4;
/// Least length of an interval that must be seen, in frames.
constexpr double kSeenFrames = 3.0;
/// Share of lit frames that may lie outside of all intervals.
constexpr double kStrayShare = 0.01;
/// Least lead over another answer, in unexplained frames.
constexpr double kClearlyBetter = 3.0;
/// Largest error of a first guess, in frames.
constexpr double kGuessFrames = 6.0;
/// Stretches of time from each of which the frames that say most are taken, and how many of either side.
constexpr std::size_t kStretches = 10;
constexpr std::size_t kOfEachSide = 4;
constexpr int kMostRounds = 20;
constexpr double kStillNarrows = 0.99;

/// Where the exposures of frames lie on the clock of the pins, as far as is known.
struct Knowledge {
  CameraClock clock;
  double first_stamp_s{};
  double guess_error_s{};  ///< At the first stamp, as long as there are no bounds; grows with the drift.
  double guess_drift{};

  [[nodiscard]] double error_s(double stamp_s) const {
    return clock.uncertaintyAt_s(stamp_s) + guess_error_s + guess_drift * std::abs(stamp_s - first_stamp_s);
  }
};

class LightFit {
 public:
  LightFit(std::span<const FrameLight> frames, std::span<const LightInterval> intervals,
           const LightProfile* profile, double period_s, const CameraClockOptions& options)
      : frames_(frames), profile_(profile), intervals_(intervals), period_s_(period_s), options_(options) {
    for (const FrameLight& frame : frames) {
      if (frame.isLit()) lit_s_.push_back(frame.stamp_s);
    }
    if (options.is_light_hard) findTurns();
  }

  CameraClockFit run() {
    CameraClockFit fit;
    if (intervals_.empty()) {
      fit.why_not = "the pins show no light";
    } else if (lit_s_.empty()) {
      fit.why_not = fmt::format("none of {} frames shows light", frames_.size());
    } else if (const auto offset_s = guess(fit.why_not)) {
      return narrowed(*offset_s);
    }
    return fit;
  }

 private:
  struct Guess {
    double offset_s{};     ///< Pins' time less the camera's.
    double strays{};       ///< Lit frames outside of all intervals.
    double unexplained{};  ///< Strays, and intervals without a lit frame.
  };

  /// Begins of light after two or more dark frames.
  [[nodiscard]] std::vector<double> beginsOfLight() const {
    std::vector<double> begins;
    double last_s = -std::numeric_limits<double>::infinity();
    for (const double stamp_s : lit_s_) {
      if (stamp_s - last_s > 2.5 * period_s_ && begins.size() < kTriedBegins) begins.push_back(stamp_s);
      last_s = stamp_s;
    }
    return begins;
  }

  /// The interval nearest to an exposure that begins then, and how far it is away; 0 within.
  [[nodiscard]] std::pair<std::size_t, double> nearest(double begin_s) const {
    const auto away_s = [&](const LightInterval& i) {
      return std::max({i.on_s - begin_s - options_.exposure_s, begin_s - i.off_s, 0.0});
    };
    const auto next = std::ranges::upper_bound(intervals_, begin_s, {}, &LightInterval::on_s);
    auto best = next == intervals_.end() ? next - 1 : next;
    if (next != intervals_.begin() && away_s(*(next - 1)) <= away_s(*best)) best = next - 1;
    return {static_cast<std::size_t>(best - intervals_.begin()), away_s(*best)};
  }

  [[nodiscard]] Guess judged(double offset_s) const {
    Guess result{offset_s, 0.0, 0.0};
    std::vector<char> is_seen(intervals_.size());
    for (const double stamp_s : lit_s_) {
      const double slack_s = options_.edge_error_s + options_.stamp_jitter_s + period_s_ +
                             options_.max_drift * (stamp_s - lit_s_.front());
      const auto [interval, away_s] = nearest(stamp_s + offset_s);
      if (away_s <= slack_s) {
        is_seen[interval] = 1;
      } else {
        result.strays += 1.0;
      }
    }
    result.unexplained = result.strays;
    for (std::size_t i = 0; i < intervals_.size(); ++i) {
      const double frames = (intervals_[i].off_s - intervals_[i].on_s) / period_s_;
      if (is_seen[i] == 0 && frames > kSeenFrames)
        result.unexplained += std::min(frames, 2.0 * kClearlyBetter);
    }
    return result;
  }

  [[nodiscard]] double guessError_s() const {
    return options_.edge_error_s + options_.exposure_s + kGuessFrames * period_s_;
  }

  std::optional<double> guess(std::string& why_not) const {
    std::vector<Guess> guesses;
    for (const double begin_s : beginsOfLight()) {
      for (const LightInterval& interval : intervals_) {
        // The light is seen as it comes on, or where it is soft some frames later.
        for (const double later_frames : {0.0, 1.0, 3.0})
          guesses.push_back(judged(interval.on_s - begin_s + later_frames * period_s_));
      }
    }
    std::ranges::stable_sort(guesses, {}, &Guess::unexplained);
    const Guess& best = guesses.front();
    if (best.strays > kStrayShare * static_cast<double>(lit_s_.size()) + 1.0) {
      why_not = fmt::format(
          "however the clocks lie to each other, {} of {} lit frames fall outside of the times of light",
          best.strays, lit_s_.size());
      return std::nullopt;
    }
    for (const Guess& other : guesses) {
      if (other.unexplained >= best.unexplained + kClearlyBetter) break;
      if (std::abs(other.offset_s - best.offset_s) <= guessError_s()) continue;
      why_not = fmt::format("the frames fit the light {:.3g} s later as well: its times are too much alike",
                            other.offset_s - best.offset_s);
      return std::nullopt;
    }
    return best.offset_s;
  }

  /// From the first interval that a frame can show to the last.
  [[nodiscard]] std::optional<BeginSighting> sightingOf(double stamp_s, const Knowledge& known) const {
    const double slack_s = known.error_s(stamp_s) + options_.stamp_jitter_s + options_.edge_error_s;
    const double from_s = known.clock.beginOf_s(stamp_s) - slack_s;
    const double to_s = known.clock.beginOf_s(stamp_s) + options_.exposure_s + slack_s;
    const auto end = std::ranges::upper_bound(intervals_, to_s, {}, &LightInterval::on_s);
    const auto begin = std::ranges::lower_bound(intervals_.begin(), end, from_s, {}, &LightInterval::off_s);
    if (begin == end) return std::nullopt;  // A reflex; the guess has counted it.
    return BeginSighting{stamp_s, begin->on_s - options_.exposure_s, (end - 1)->off_s};
  }

  /// Where frames turn from dark to lit or back.
  struct Turn {
    double dark_s{}, lit_s{};  ///< Stamps.
    double share{};            ///< Light in the lit frame over that in the frames next to it.
    double share_error{};      ///< Difference between the frames next to it.
    [[nodiscard]] bool isBegin() const { return dark_s < lit_s; }
  };

  /// Takes frames from the `lit`th on, `step` after `step`.
  [[nodiscard]] std::optional<Turn> turnAt(std::ptrdiff_t lit, std::ptrdiff_t step) const {
    constexpr std::ptrdiff_t kNext = 5;
    const auto count = static_cast<std::ptrdiff_t>(frames_.size());
    const auto inside = [&](std::ptrdiff_t i) { return i >= 0 && i < count; };
    // Two of either side: a spot that was missed for one frame is no edge.
    if (!inside(lit - 2 * step) || !inside(lit + kNext * step)) return std::nullopt;
    const auto at = [&](std::ptrdiff_t i) -> const FrameLight& {
      return frames_[static_cast<std::size_t>(lit + i * step)];
    };
    if (at(-2).isLit() || at(-1).isLit() || std::abs(at(0).stamp_s - at(-1).stamp_s) > 1.5 * period_s_)
      return std::nullopt;
    std::array<double, kNext> next{};
    for (std::ptrdiff_t i = 0; i < kNext; ++i) next.at(static_cast<std::size_t>(i)) = at(i + 1).light;
    std::ranges::sort(next);
    if (!at(0).isLit() || next.front() <= 0.0) return std::nullopt;
    const double full = next[kNext / 2];
    return Turn{at(-1).stamp_s, at(0).stamp_s, at(0).light / full, (next.back() - next.front()) / full};
  }

  void findTurns() {
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(frames_.size()); ++i) {
      for (const std::ptrdiff_t step : {1, -1}) {
        if (const auto turn = turnAt(i, step)) turns_.push_back(*turn);
      }
    }
  }

  /// When the pins switched a hard light at a turn; nothing where that can have been more than one interval.
  [[nodiscard]] std::optional<double> edgeOf(const Turn& turn, const Knowledge& known) const {
    const double slack_s = known.error_s(turn.lit_s) + options_.stamp_jitter_s + options_.edge_error_s;
    const double from_s = known.clock.beginOf_s(std::min(turn.dark_s, turn.lit_s)) - slack_s;
    const double to_s =
        known.clock.beginOf_s(std::max(turn.dark_s, turn.lit_s)) + options_.exposure_s + slack_s;
    const auto meets = [&](const LightInterval& i) { return i.off_s > from_s && i.on_s < to_s; };
    const auto found = std::ranges::find_if(intervals_, meets);
    if (found == intervals_.end() || std::ranges::count_if(intervals_, meets) != 1) return std::nullopt;
    const double edge_s = turn.isBegin() ? found->on_s : found->off_s;
    if (edge_s < from_s || edge_s > to_s) return std::nullopt;  // Dark within the light: not what was asked.
    return edge_s;
  }

  /// At a turn the dark frame's exposure lies outside of the light, and the lit one's has its share of it.
  void addTurns(const Knowledge& known, std::vector<BeginSighting>& sightings) const {
    constexpr double kAnyTime_s = 1e3;
    const double exposure_s = options_.exposure_s;
    const double unseen_s = exposure_s * options_.unseen_share;
    for (const Turn& turn : turns_) {
      const auto edge_s = edgeOf(turn, known);
      if (!edge_s) continue;
      const double error = options_.share_error + turn.share_error;
      const double least_s = std::max(0.0, turn.share - error) * exposure_s;
      const double most_s = turn.share + error < 1.0 ? (turn.share + error) * exposure_s : kAnyTime_s;
      if (turn.isBegin()) {
        const double end_s = *edge_s - exposure_s;  // An exposure that began then ended with the edge.
        sightings.push_back({turn.dark_s, end_s - kAnyTime_s, end_s + unseen_s});
        sightings.push_back({turn.lit_s, end_s + least_s, end_s + most_s});
      } else {
        sightings.push_back({turn.dark_s, *edge_s - unseen_s, *edge_s + kAnyTime_s});
        sightings.push_back({turn.lit_s, *edge_s - most_s, *edge_s - least_s});
      }
    }
  }

  /// Keeps for each stretch of time those that bound the clock most on either side.
  [[nodiscard]] std::vector<BeginSighting> telling(std::vector<BeginSighting> all) const {
    std::vector<BeginSighting> chosen;
    const auto take = [&](std::vector<BeginSighting> some, const auto& bound) {
      const std::size_t count = std::min(kOfEachSide, some.size());
      std::ranges::partial_sort(some, some.begin() + static_cast<std::ptrdiff_t>(count), {}, bound);
      chosen.insert(chosen.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
    };
    for (std::size_t i = 0; i < kStretches; ++i) {
      const auto at = [&](std::size_t k) {
        return all.begin() + static_cast<std::ptrdiff_t>(k * all.size() / kStretches);
      };
      const std::vector<BeginSighting> stretch(at(i), at(i + 1));
      take(stretch, [](const BeginSighting& s) { return s.stamp_s - s.earliest_s; });
      take(stretch, [](const BeginSighting& s) { return s.latest_s - s.stamp_s; });
    }
    return chosen;
  }

  CameraClockFit narrowed(double offset_s) const {
    Knowledge known{CameraClock(lit_s_.front(), {{offset_s, 0.0}}), lit_s_.front(), guessError_s(),
                    options_.max_drift};
    CameraClockOptions wide = options_;
    wide.max_uncertainty_s = std::numeric_limits<double>::infinity();
    std::vector<BeginSighting> sightings;
    for (int round = 0; round < kMostRounds; ++round) {
      sightings.clear();
      for (const double stamp_s : lit_s_) {
        if (const auto seen = sightingOf(stamp_s, known)) sightings.push_back(*seen);
      }
      sightings = telling(std::move(sightings));
      // Light of which a dark frame is a neighbour: it follows from a clock that is roughly known.
      if (round > 0) addTurns(known, sightings);
      CameraClockFit fit = fitCameraClockToBegins(sightings, wide);
      if (!fit.clock) return fit;
      const double before_s = known.error_s(lit_s_.back());
      known = {*fit.clock, lit_s_.front(), 0.0, 0.0};
      if (round > 0 && known.error_s(lit_s_.back()) > kStillNarrows * before_s) break;
    }
    if (profile_ != nullptr) {
      if (auto clock = sharpened(known.clock, frames_, *profile_, options_))
        return checked(std::move(*clock));
    }
    return fitCameraClockToBegins(sightings, options_);
  }

  [[nodiscard]] CameraClockFit checked(CameraClock clock) const {
    CameraClockFit fit;
    const double worst_s =
        std::max(clock.uncertaintyAt_s(lit_s_.front()), clock.uncertaintyAt_s(lit_s_.back()));
    if (worst_s <= options_.max_uncertainty_s) {
      fit.clock = std::move(clock);
    } else {
      fit.why_not = fmt::format("the light tells the offset to ±{:.3g} ms only, and ±{:.3g} ms are asked for",
                                1e3 * worst_s, 1e3 * options_.max_uncertainty_s);
    }
    return fit;
  }

  std::span<const FrameLight> frames_;
  const LightProfile* profile_;
  std::span<const LightInterval> intervals_;
  double period_s_;
  const CameraClockOptions& options_;
  std::vector<double> lit_s_;
  std::vector<Turn> turns_;  ///< Instants at which a hard light goes on or off.
};

}  // namespace

CameraClockFit fitLightClock(std::span<const FrameLight> frames, std::span<const LightInterval> intervals,
                             const LightProfile* profile, double period_s,
                             const CameraClockOptions& options) {
  return LightFit(frames, intervals, profile, period_s, options).run();
}

}  // namespace kerfbench::camera
