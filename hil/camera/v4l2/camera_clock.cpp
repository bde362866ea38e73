// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/camera_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/base/add_to_list.h"

namespace kerfbench::camera {
namespace {

using Line = CameraClock::Line;
using Polygon = std::vector<Line>;

/// low <= offset + drift * since_s <= high.
struct Band {
  double since_s{};
  double low_s{};
  double high_s{};
};

Band bandOf(const EdgeSighting& seen, double reference_stamp_s, const CameraClockOptions& options) {
  const double exposure_s = options.exposure_s;
  const double apart_s = seen.lit_stamp_s - seen.dark_stamp_s;
  const double slack_s = options.stamp_jitter_s + options.edge_error_s;
  // How long after the begin of the lit frame the edge was, at least and at most.
  double least_s = exposure_s * (1.0 - options.unseen_share) - apart_s * (1.0 + options.max_drift) - slack_s;
  double most_s = exposure_s + slack_s;
  if (seen.lit_share) {
    const double most_lit = *seen.lit_share + options.share_error;
    const double least_lit = std::max(0.0, *seen.lit_share - options.share_error);
    if (most_lit < 1.0) least_s = std::max(least_s, exposure_s * (1.0 - most_lit) - slack_s);
    most_s = exposure_s * (1.0 - least_lit) + slack_s;
  }
  const double edge_s = seen.edge_s - seen.row_delay_s - seen.lit_stamp_s;
  return {seen.lit_stamp_s - reference_stamp_s, edge_s - most_s, edge_s - least_s};
}

Band bandOf(const BeginSighting& seen, double reference_stamp_s, const CameraClockOptions& options) {
  const double slack_s = options.stamp_jitter_s + options.edge_error_s;
  return {seen.stamp_s - reference_stamp_s, seen.earliest_s - slack_s - seen.stamp_s,
          seen.latest_s + slack_s - seen.stamp_s};
}

/// What of a convex polygon lies where room(corner) >= 0 (Sutherland and Hodgman 1974); room is linear.
template <typename Room>
Polygon clip(const Polygon& polygon, const Room& room) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Line& a = polygon[i];
    const Line& b = polygon[(i + 1) % polygon.size()];
    const double room_a = room(a);
    const double room_b = room(b);
    if (room_a >= 0.0) kept.push_back(a);
    if ((room_a >= 0.0) != (room_b >= 0.0)) {
      const double t = room_a / (room_a - room_b);
      kept.push_back({std::lerp(a.offset_s, b.offset_s, t), std::lerp(a.drift, b.drift, t)});
    }
  }
  return kept;
}

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// What all bands but one allow.
Polygon allowedBy(std::span<const Band> bands, std::size_t left_out, double max_drift) {
  double low_s = std::numeric_limits<double>::infinity();
  double high_s = -low_s;
  for (const Band& band : bands) {
    const double swing_s = max_drift * std::abs(band.since_s);
    low_s = std::min(low_s, band.low_s - swing_s);
    high_s = std::max(high_s, band.high_s + swing_s);
  }
  Polygon allowed{{low_s, -max_drift}, {high_s, -max_drift}, {high_s, max_drift}, {low_s, max_drift}};
  for (std::size_t i = 0; i < bands.size() && !allowed.empty(); ++i) {
    if (i == left_out) continue;
    const Band& band = bands[i];
    const auto at = [&](const Line& line) { return line.offset_s + line.drift * band.since_s; };
    allowed = clip(allowed, [&](const Line& line) { return at(line) - band.low_s; });
    allowed = clip(allowed, [&](const Line& line) { return band.high_s - at(line); });
  }
  return allowed;
}

bool within(double value, double min, double max) { return value >= min && value <= max; }

std::string faultsOf(const CameraClockOptions& options) {
  std::string faults;
  const auto check = [&](bool good, const char* text) {
    if (!good) base::addToList(faults, text, "; ");
  };
  constexpr double kLong_s = 1e6;
  check(options.exposure_s > 0.0 && options.exposure_s <= kLong_s, "exposure_s must be > 0");
  check(within(options.stamp_jitter_s, 0.0, kLong_s), "stamp_jitter_s must be >= 0");
  check(within(options.edge_error_s, 0.0, kLong_s), "edge_error_s must be >= 0");
  check(within(options.unseen_share, 0.0, 1.0), "unseen_share must be in [0, 1]");
  check(within(options.share_error, 0.0, 1.0), "share_error must be in [0, 1]");
  check(within(options.max_drift, 0.0, 0.1), "max_drift must be in [0, 0.1]");
  check(options.max_uncertainty_s > 0.0, "max_uncertainty_s must be > 0");
  return faults;
}

/// Empty for a sighting that can be used.
std::string faultOf(const EdgeSighting& seen) {
  if (!std::isfinite(seen.edge_s) || !std::isfinite(seen.dark_stamp_s) || !std::isfinite(seen.lit_stamp_s) ||
      !std::isfinite(seen.row_delay_s))
    return "has a time that is no number";
  if (seen.lit_stamp_s <= seen.dark_stamp_s) return "has its lit frame not after its dark one";
  if (seen.lit_share && !within(*seen.lit_share, 0.0, 1.0)) return "has a share of light outside 0 ... 1";
  return {};
}

std::string faultOf(const BeginSighting& seen) {
  if (!std::isfinite(seen.stamp_s) || !std::isfinite(seen.earliest_s) || !std::isfinite(seen.latest_s))
    return "has a time that is no number";
  return seen.latest_s >= seen.earliest_s ? "" : "has a frame that begins later than at its latest";
}

double stampOf(const EdgeSighting& seen) { return seen.lit_stamp_s; }
double stampOf(const BeginSighting& seen) { return seen.stamp_s; }

struct Survey {
  std::vector<Line> corners;
  std::vector<std::size_t> suspects;
};

/// Corners of the polygons of all bands but one; suspects where only leaving one out makes the rest agree.
Survey surveyOf(std::span<const Band> bands, double max_drift) {
  Survey survey;
  const bool all_agree = !allowedBy(bands, kNone, max_drift).empty();
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const Polygon allowed = allowedBy(bands, i, max_drift);
    if (!all_agree && !allowed.empty()) survey.suspects.push_back(i);
    survey.corners.insert(survey.corners.end(), allowed.begin(), allowed.end());
  }
  const auto key = [](const Line& line) { return std::pair(line.offset_s, line.drift); };
  std::ranges::sort(survey.corners, {}, key);
  // std::ranges::unique of GCC 12 is none to clang 14.
  const auto same = std::unique(survey.corners.begin(), survey.corners.end(),
                                [&](const Line& a, const Line& b) { return key(a) == key(b); });
  survey.corners.erase(same, survey.corners.end());
  return survey;
}

template <typename Sighting>
CameraClockFit fitted(std::span<const Sighting> sightings, const CameraClockOptions& options) {
  if (const std::string faults = faultsOf(options); !faults.empty())
    throw std::invalid_argument("fitCameraClock: " + faults);
  /// Least sightings of a fit: of two that contradict each other neither can be trusted.
  constexpr std::size_t kLeast = 3;
  CameraClockFit fit;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (const std::string fault = faultOf(sightings[i]); !fault.empty()) {
      fit.why_not = fmt::format("sighting {} {}", i, fault);
      return fit;
    }
  }
  if (sightings.size() < kLeast) {
    fit.why_not = fmt::format("{} sightings; one may be wrong, so {} are needed", sightings.size(), kLeast);
    return fit;
  }
  const auto [first, last] =
      std::ranges::minmax(sightings, {}, [](const Sighting& seen) { return stampOf(seen); });
  const double reference_s = std::midpoint(stampOf(first), stampOf(last));
  std::vector<Band> bands;
  for (const Sighting& seen : sightings) bands.push_back(bandOf(seen, reference_s, options));
  Survey survey = surveyOf(bands, options.max_drift);
  fit.suspects = std::move(survey.suspects);
  if (survey.corners.empty()) {
    fit.why_not = "the sightings contradict each other, whichever one is left out";
    return fit;
  }
  CameraClock clock(reference_s, std::move(survey.corners));
  const double worst_s =
      std::max(clock.uncertaintyAt_s(stampOf(first)), clock.uncertaintyAt_s(stampOf(last)));
  if (worst_s > options.max_uncertainty_s) {
    fit.why_not = fmt::format(
        "the sightings tell the offset to ±{:.3g} ms only, and ±{:.3g} ms are asked for: too few of them, or "
        "all at the same place of a frame",
        worst_s * 1e3, options.max_uncertainty_s * 1e3);
    return fit;
  }
  fit.clock = std::move(clock);
  return fit;
}

}  // namespace

CameraClock::CameraClock(double reference_stamp_s, std::vector<Line> corners)
    : reference_stamp_s_(reference_stamp_s), corners_(std::move(corners)) {
  if (corners_.empty()) throw std::invalid_argument("CameraClock: no line");
  const auto [low, high] = std::ranges::minmax(corners_, {}, &Line::offset_s);
  const auto [slow, fast] = std::ranges::minmax(corners_, {}, &Line::drift);
  middle_ = {std::midpoint(low.offset_s, high.offset_s), std::midpoint(slow.drift, fast.drift)};
}

double CameraClock::beginOf_s(double stamp_s) const {
  return stamp_s + middle_.offset_s + middle_.drift * (stamp_s - reference_stamp_s_);
}

double CameraClock::uncertaintyAt_s(double stamp_s) const {
  double most_s = 0.0;
  for (const Line& line : corners_) {
    const double off_s =
        line.offset_s - middle_.offset_s + (line.drift - middle_.drift) * (stamp_s - reference_stamp_s_);
    most_s = std::max(most_s, std::abs(off_s));
  }
  return most_s;
}

double CameraClock::driftUncertainty() const {
  double most = 0.0;
  for (const Line& line : corners_) most = std::max(most, std::abs(line.drift - middle_.drift));
  return most;
}

CameraClockFit fitCameraClock(std::span<const EdgeSighting> sightings, const CameraClockOptions& options) {
  return fitted(sightings, options);
}

CameraClockFit fitCameraClockToBegins(std::span<const BeginSighting> sightings,
                                      const CameraClockOptions& options) {
  return fitted(sightings, options);
}

}  // namespace kerfbench::camera
