// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/light_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "twin/base/statistics.h"

namespace kerfbench::camera {
namespace {

constexpr std::size_t kFewest = 40;
constexpr std::size_t kMostFrames = 4000;  // Most frames of a fit.
constexpr std::size_t kTried = 400;        // Most frames with which all places are tried.
constexpr std::size_t kBlocks = 10;
constexpr double kCoverage = 4.1;  // 99.7 % by Student's t of kBlocks - 1 degrees of freedom.
/// Light is a mix of what is asked for during the exposure and around it, spread by so much either way: a
/// laser may show each pulse of its PWM, or none.
constexpr std::array kSpreads_s{0.0, 0.5e-3, 2e-3};
constexpr int kGains = static_cast<int>(kSpreads_s.size());
/// Steps in which places are tried, to the window in which light is gathered.
constexpr double kStepsToWindow = 8.0;
/// Most places that are tried; they take about a second.
constexpr double kMostPlaces = 50'000.0;
/// Least distance of two places that are not the same, in windows.
constexpr double kApart = 2.0;
/// Least factor by which any other place must leave more.
constexpr double kClearlyBrighter = 1.05;
/// Factor up to which a neighbour that leaves more may be the true place, by noise.
constexpr double kRival = 1.15;
/// Largest share of the light that the fit may leave: a strobe that shows single pulses says nothing of their
/// number.
constexpr double kUnexplained = 0.15;
constexpr double kFinest_s = 1e-6;
constexpr double kOutlier = 5.0;  // Standard deviations.

using Gains = Eigen::Matrix<double, kGains, 1>;
using GainMatrix = Eigen::Matrix<double, kGains, kGains>;

/// Time on since a begin, tabled: places are tried by the hundred thousand.
class OnTable {
 public:
  OnTable(const LightProfile& profile, double from_s, double to_s) : from_s_(from_s) {
    constexpr double kResolution_s = 5e-6;
    constexpr double kLongestTable = 4e6;
    step_s_ = std::max(kResolution_s, (to_s - from_s) / kLongestTable);
    const auto count = static_cast<std::size_t>((to_s - from_s) / step_s_) + 2;
    on_s_.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
      on_s_.push_back(profile.onUntil_s(from_s + static_cast<double>(i) * step_s_));
  }
  [[nodiscard]] double meanOver(double from_s, double to_s) const {
    return (at(to_s) - at(from_s)) / (to_s - from_s);
  }

 private:
  [[nodiscard]] double at(double time_s) const {
    const double place = std::clamp((time_s - from_s_) / step_s_, 0.0, static_cast<double>(on_s_.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), on_s_.size() - 2);
    return std::lerp(on_s_[i], on_s_[i + 1], place - static_cast<double>(i));
  }
  double from_s_, step_s_{};
  std::vector<double> on_s_;
};

/// In which light is gathered, by the narrowest of the spreads from `scale` on.
double windowOf_s(std::size_t scale, const CameraClockOptions& options) {
  return options.exposure_s + 2.0 * kSpreads_s.at(scale);
}

/// How much light is asked for when `lit` was exposed, wherever `rough` may put that.
OnTable tableOf(const LightProfile& profile, const CameraClock& rough, const std::vector<FrameLight>& lit) {
  const double first_s = lit.front().stamp_s;
  const double last_s = lit.back().stamp_s;
  const double around_s = 0.1 + 2.0 * std::max(rough.uncertaintyAt_s(first_s), rough.uncertaintyAt_s(last_s));
  return {profile, rough.beginOf_s(first_s) - around_s, rough.beginOf_s(last_s) + around_s};
}

/// Begin of exposure = rough clock + late + swing * (stamp - middle) / half of the span, both in seconds;
/// light = gains * what is asked for then, by spreads from `scale` on.
class LightRegression {
 public:
  LightRegression(const CameraClock& rough, const std::vector<FrameLight>& lit, const OnTable& on,
                  std::size_t scale, const CameraClockOptions& options)
      : rough_(rough),
        options_(options),
        scale_(scale),
        window_s_(windowOf_s(scale, options)),
        middle_s_(0.5 * (lit.front().stamp_s + lit.back().stamp_s)),
        half_span_s_(std::max(lit.back().stamp_s - middle_s_, 1e-3)),
        reach_s_(reachOf(rough, lit)),
        on_(on) {
    for (const FrameLight& frame : lit)
      seen_.push_back(
          {rough_.beginOf_s(frame.stamp_s), (frame.stamp_s - middle_s_) / half_span_s_, frame.light});
  }

  /// How many are to be tried, of all that the rough clock allows.
  [[nodiscard]] double places() const {
    return (2.0 * stepsIn(reach_s_) + 1.0) * (2.0 * stepsIn(mostSwing_s()) + 1.0);
  }

  std::optional<CameraClock> run() {
    const std::optional<Place> found = best();
    if (!found) return std::nullopt;
    leaveOutliers(*found);
    if (seen_.size() < kFewest) return std::nullopt;
    const Place fit = descended(*found, kBlocks);
    if (fit.left > kUnexplained * leftOfNoClock()) return std::nullopt;
    double late_variance = 0.0;
    double swing_variance = 0.0;
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const Place without = descended(fit, block);
      late_variance += std::pow(without.late_s - fit.late_s, 2);
      swing_variance += std::pow(without.swing_s - fit.swing_s, 2);
    }
    constexpr double kJackknife = (kBlocks - 1.0) / kBlocks;
    // Blurred light may mislead all frames alike, by less than it is blurred; and where pulses are about as
    // long as an exposure, it may be a neighbouring minimum, which leaving out a tenth does not show.
    const double late_bound_s = kCoverage * std::sqrt(kJackknife * late_variance) + options_.edge_error_s +
                                kSpreads_s.at(scale_) + found->rivals_s;
    const double swing_bound_s = kCoverage * std::sqrt(kJackknife * swing_variance);
    if (!(late_bound_s + swing_bound_s < reach_s_)) return std::nullopt;
    if (std::abs(fit.late_s) > reach_s_ + late_bound_s) return std::nullopt;
    return clockOf(fit, late_bound_s, swing_bound_s);
  }

 private:
  struct Seen {
    double begin_s{};  ///< Begin of the exposure by the rough clock.
    double place{};    ///< Position in the span, -1 … 1.
    double light{};
  };
  /// Shift of the clock, and the sum of squares that it leaves of the light.
  struct Place {
    double late_s{}, swing_s{};
    Gains gains{Gains::Zero()};
    double left{};
    double rivals_s{};  ///< How far from best() another place fits nearly as well.
  };

  static double reachOf(const CameraClock& rough, const std::vector<FrameLight>& lit) {
    double reach_s = 0.0;
    for (const FrameLight& frame : lit) reach_s = std::max(reach_s, rough.uncertaintyAt_s(frame.stamp_s));
    return reach_s;
  }

  [[nodiscard]] Gains asked(double begin_s) const {
    Gains asked = Gains::Zero();
    for (std::size_t k = scale_; k < kSpreads_s.size(); ++k) {
      const double spread_s = kSpreads_s.at(k);
      asked[static_cast<int>(k)] = on_.meanOver(begin_s - spread_s, begin_s + options_.exposure_s + spread_s);
    }
    return asked;
  }
  [[nodiscard]] double mostSwing_s() const {
    return std::max(std::min(options_.max_drift, rough_.driftUncertainty()) * half_span_s_, 1e-9);
  }
  [[nodiscard]] double step_s() const { return window_s_ / kStepsToWindow; }
  [[nodiscard]] double stepsIn(double time_s) const { return std::ceil(time_s / step_s()); }

  [[nodiscard]] CameraClock clockOf(const Place& best, double late_bound_s, double swing_bound_s) const {
    const double offset_s = rough_.beginOf_s(middle_s_) - middle_s_ + best.late_s;
    const double drift = rough_.line().drift + best.swing_s / half_span_s_;
    std::vector<CameraClock::Line> corners;
    for (const double late : {-1.0, 1.0}) {
      for (const double fast : {-1.0, 1.0})
        corners.push_back({offset_s + late * late_bound_s, drift + fast * swing_bound_s / half_span_s_});
    }
    return {middle_s_, std::move(corners)};
  }

  /// What is left where all light is taken to be alike.
  [[nodiscard]] double leftOfNoClock() const {
    double sum = 0.0;
    double squares = 0.0;
    for (const Seen& seen : seen_) {
      sum += seen.light;
      squares += seen.light * seen.light;
    }
    return squares - sum * sum / static_cast<double>(seen_.size());
  }

  [[nodiscard]] Place placed(double late_s, double swing_s, std::size_t stride, std::size_t without) const {
    double light_light = 0.0;
    Gains light_asked = Gains::Zero();
    GainMatrix asked_asked = 1e-9 * GainMatrix::Identity();
    for (std::size_t i = 0; i < seen_.size(); i += stride) {
      if (i * kBlocks / seen_.size() == without) continue;
      const Seen& seen = seen_[i];
      const Gains a = asked(seen.begin_s + late_s + swing_s * seen.place);
      light_light += seen.light * seen.light;
      light_asked += seen.light * a;
      asked_asked += a * a.transpose();
    }
    const Gains gains = asked_asked.ldlt().solve(light_asked);
    return {late_s, swing_s, gains, light_light - light_asked.dot(gains)};
  }

  /// The best of all places that the rough clock allows; nothing where another fits nearly as well.
  [[nodiscard]] std::optional<Place> best() const {
    const std::size_t stride = std::max<std::size_t>(1, seen_.size() / kTried);
    const auto swings = static_cast<int>(stepsIn(mostSwing_s()));
    const auto lates = static_cast<int>(stepsIn(reach_s_));
    std::vector<Place> of_lates;
    for (int late = -lates; late <= lates; ++late) {
      Place best{.left = std::numeric_limits<double>::infinity()};
      for (int swing = -swings; swing <= swings; ++swing) {
        const Place next = placed(late * step_s(), swing * step_s(), stride, kBlocks);
        if (next.left < best.left) best = next;
      }
      of_lates.push_back(best);
    }
    Place first = *std::ranges::min_element(of_lates, {}, &Place::left);
    for (const Place& other : of_lates) {
      const double away_s = std::abs(other.late_s - first.late_s);
      const bool is_apart = away_s > kApart * window_s_;
      if (is_apart && other.left < kClearlyBrighter * first.left) return std::nullopt;
      // Blurred light has no neighbours.
      if (scale_ == 0 && !is_apart && other.left < kRival * first.left)
        first.rivals_s = std::max(first.rivals_s, away_s);
    }
    return first;
  }

  /// The best place near one, without the frames of one block; kBlocks: with all. Pattern search: what is
  /// left of pulses has no slope to go by.
  [[nodiscard]] Place descended(Place at, std::size_t without) const {
    constexpr std::array<std::array<double, 2>, 4> kWays{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    at = placed(at.late_s, at.swing_s, 1, without);
    for (double way_s = step_s(); way_s > kFinest_s;) {
      bool is_better = false;
      for (const auto& [late, swing] : kWays) {
        const double swing_s = std::clamp(at.swing_s + swing * way_s, -mostSwing_s(), mostSwing_s());
        const Place next = placed(at.late_s + late * way_s, swing_s, 1, without);
        if (next.left >= at.left) continue;
        at = next;
        is_better = true;
      }
      if (!is_better) way_s *= 0.5;
    }
    return at;
  }

  /// Frames that do not fit say nothing: a spot on a mark, say.
  void leaveOutliers(const Place& at) {
    std::vector<double> off;
    for (const Seen& seen : seen_)
      off.push_back(
          std::abs(seen.light - at.gains.dot(asked(seen.begin_s + at.late_s + at.swing_s * seen.place))));
    const double most = kOutlier * kMadToSigma * upperMedianOf(off);
    std::size_t i = 0;
    std::erase_if(seen_, [&](const Seen&) { return off[i++] > most; });
  }

  const CameraClock& rough_;
  const CameraClockOptions& options_;
  std::size_t scale_;
  double window_s_, middle_s_, half_span_s_, reach_s_;
  const OnTable& on_;
  std::vector<Seen> seen_;
};

/// Clock at the finest scale that the jitter of the stamps allows and that needs no more than kMostPlaces.
std::optional<CameraClock> sharpenedAtBestScale(const CameraClock& rough, const std::vector<FrameLight>& lit,
                                                const LightProfile& profile,
                                                const CameraClockOptions& options) {
  const OnTable on = tableOf(profile, rough, lit);
  for (std::size_t scale = 0; scale < kSpreads_s.size(); ++scale) {
    const bool is_last = scale + 1 == kSpreads_s.size();
    if (windowOf_s(scale, options) < 2.0 * options.stamp_jitter_s && !is_last) continue;
    LightRegression regression(rough, lit, on, scale, options);
    if (regression.places() <= kMostPlaces) return regression.run();
  }
  return std::nullopt;
}

}  // namespace

LightProfile::LightProfile(std::span<const Step> steps) {
  for (const Step& step : steps) {
    const double on_s = knots_.empty() ? 0.0 : onUntil_s(step.time_s);
    knots_.push_back({step.time_s, on_s, step.is_on});
  }
}

double LightProfile::onUntil_s(double time_s) const {
  const auto next = std::ranges::upper_bound(knots_, time_s, {}, &Knot::time_s);
  if (next == knots_.begin()) return 0.0;
  const Knot& last = *(next - 1);
  return last.on_s + (last.is_on ? time_s - last.time_s : 0.0);
}

double LightProfile::meanOver(double from_s, double to_s) const {
  return (onUntil_s(to_s) - onUntil_s(from_s)) / (to_s - from_s);
}

std::optional<CameraClock> sharpened(const CameraClock& rough, std::span<const FrameLight> frames,
                                     const LightProfile& profile, const CameraClockOptions& options) {
  std::vector<FrameLight> lit;
  std::ranges::copy_if(frames, std::back_inserter(lit), &FrameLight::isLit);
  if (lit.size() < kFewest) return std::nullopt;
  if (lit.size() > kMostFrames) {
    std::vector<FrameLight> some;
    for (std::size_t i = 0; i < kMostFrames; ++i) some.push_back(lit[i * lit.size() / kMostFrames]);
    lit = std::move(some);
  }
  return sharpenedAtBestScale(rough, lit, profile, options);
}

}  // namespace kerfbench::camera
