// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/kerf_joint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "hil/vision/corner/corner_legs.h"
#include "hil/vision/kerf/kerf_leg.h"
#include "hil/vision/kerf/kerf_outline.h"
#include "hil/vision/kerf/kerf_profile.h"
#include "twin/base/constants.h"

namespace kerfbench::vision {
namespace {

// What the outline's model leaves: 1.5 um on pictures of its own world (kerf_joint_test), and as much again
// in worlds of other light, walls and lenses (kerfbench gauge --mismatch).
constexpr double kEndMm = 0.002;
constexpr double kFaintEndMm = 0.0023;
constexpr double kThrough = 0.75;  // Least brightness of a kerf that is cut through.
/// Distance inside of an end from which it is looked at; less for a shorter one.
constexpr double kEndInsideMm = 0.3;
constexpr double kReachMm = 0.8;       // Reach of a look along a leg.
constexpr double kStripWidths = 0.35;  // Half width of the strip, in half kerfs.
constexpr double kWindowMm = 0.1;      // Half of the length that a caliper averages along the curve.

/// Look along a leg or a bisector.
struct Look {
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d direction{Eigen::Vector2d::UnitX()};  ///< Outwards.
  double strip_mm{};
  double brightness{};
  double
      inside_mm{};  ///< Before p_S_mm, from where on the kerf is followed; 0: from the kerf that is nearest.
};

/// Where the light falls below half way, first, going outwards.
std::optional<double> outlineMm(const JointScene& scene, const Look& look) {
  const TileView* view = scene.tileFor(look.p_S_mm, kReachMm);
  if (view == nullptr) return std::nullopt;
  const CaliperWindow window{.p_S_mm = look.p_S_mm,
                             .tangent = Eigen::Vector2d(look.direction.y(), -look.direction.x()),
                             .back_mm = look.strip_mm,
                             .ahead_mm = look.strip_mm,
                             .reach_mm = kReachMm};
  Profile profile;
  readProfile(*view, *scene.calibration, *scene.X_TS, window, {}, profile);
  const std::size_t n = profile.size();
  const std::size_t middle = n / 2;
  const double board = scene.boardAt(*view, look.p_S_mm);
  const double level = board + 0.5 * look.brightness * (scene.options->open_gray - board);
  std::size_t i = middle - std::min(middle, static_cast<std::size_t>(look.inside_mm / profile.step_mm));
  if (!(look.inside_mm > 0.0)) {
    std::optional<std::size_t> inside;
    const auto distance = [&](std::size_t at) { return at > middle ? at - middle : middle - at; };
    for (std::size_t k = 0; k < n; ++k) {
      if (profile.gray[k] >= level && (!inside || distance(k) < distance(*inside))) inside = k;
    }
    if (!inside) return std::nullopt;
    i = *inside;
  }
  if (!(profile.gray[i] >= level)) return std::nullopt;
  while (i < n && profile.gray[i] >= level) ++i;
  if (i == n) return std::nullopt;
  const double share = (profile.gray[i - 1] - level) / (profile.gray[i - 1] - profile.gray[i]);
  return profile.first_mm + (static_cast<double>(i - 1) + share) * profile.step_mm;
}

/// Half the strip that a look along a kerf averages over.
double stripOf(double half_width_mm, double pixel_mm) {
  return std::max(kStripWidths * half_width_mm, 1.0 * pixel_mm);
}

/// How far the outline reaches beyond where the beam stopped, by all views of light, beam and blur.
FlankMoments reachOf(const JointScene& scene, const Eigen::Vector2d& p_S_mm, double half_width_mm,
                     double brightness) {
  const TileView* view = scene.tileFor(p_S_mm, kReachMm);
  const double strip_mm = stripOf(half_width_mm, scene.calibration->pitchMm());
  KerfLook look{.half_width_mm = half_width_mm,
                .brightness = brightness,
                .board_gray = view == nullptr ? 0.0 : scene.boardAt(*view, p_S_mm),
                .open_gray = scene.options->open_gray,
                .pixel_mm = scene.calibration->pitchMm()};
  return scene.belief->momentsOf([&](const FlankView& seen) {
    look.growth = seen.growth;
    look.beam_radius_mm = seen.beam_radius_mm;
    look.lens_px = seen.lens_px;
    look.open_gray = scene.options->open_gray * seen.open;
    look.brightness =
        brightness * (scene.options->open_gray - look.board_gray) / (look.open_gray - look.board_gray);
    return KerfOutline(look).reachMm(strip_mm);
  });
}

/// A look through a strip against a caliper: one flank of two, and fewer pixels; and what the outline's model
/// leaves.
double lookSigma(double caliper_sigma_mm, double strip_mm, double model_mm) {
  return std::hypot(model_mm, caliper_sigma_mm * std::sqrt(2.0 * std::max(1.0, kWindowMm / strip_mm)));
}

double endSigma(double caliper_sigma_mm, double strip_mm, double brightness) {
  return lookSigma(caliper_sigma_mm, strip_mm, brightness > kThrough ? kEndMm : kFaintEndMm);
}

/// How far back along the tangent the kerf of a curve still lies.
double insideMm(const Station& station, double half_width_mm) {
  const double bend = std::abs(station.curvature_per_mm);
  return bend > 0.0 ? std::min(kReachMm, std::sqrt(half_width_mm / bend)) : kReachMm;
}

}  // namespace

LineEnd measureEnd(const JointScene& scene, const EntityEnd& end) {
  const EntityKerf& kerf = (*scene.kerfs)[end.plan];
  const std::vector<Station>& stations = scene.plan->entities[end.plan].stations;
  LineEnd out{.unit = scene.unit, .entity = kerf.entity, .at_start = end.at_start};
  out.gap_mm = out.sigma_mm = kNan;
  // From the nominal end; where no kerf comes near that, from the last caliper that saw one.
  std::size_t from = end.at_start ? 0 : stations.size() - 1;
  for (int look = 0; look < 2 && !out.found; ++look) {
    const double station_mm = stations[from].station_mm;
    const auto leg = legAt(kerf, station_mm, kLegFromMm);
    const double half_width_mm = leg ? leg->half_width_mm : 0.0;
    const double strip_mm = stripOf(half_width_mm, scene.calibration->pitchMm());
    const Eigen::Vector2d& tangent = stations[from].tangent;
    const Eigen::Vector2d outward = end.at_start ? Eigen::Vector2d(-tangent) : tangent;
    const Eigen::Vector2d left(-tangent.y(), tangent.x());
    // The kerf may lie off the nominal curve, and askew to it: look along the kerf.
    const auto lookAt = [&](const EndLine& line) -> std::optional<double> {
      const double inside_mm = std::min(kEndInsideMm, insideMm(stations[from], half_width_mm));
      const Eigen::Vector2d along = (outward - line.slope * left).normalized();
      const auto at = outlineMm(scene, {stations[from].p_S_mm + line.offset_mm * left, along, strip_mm,
                                        leg->brightness, inside_mm});
      return at ? std::optional(*at * along.dot(outward)) : std::nullopt;
    };
    if (leg) {
      auto at = lookAt(besideEnd(kerf, station_mm).value_or(EndLine{leg->offset_mm, 0.0}));
      // Where it ends tells where exactly it lies.
      const double short_mm = at ? std::clamp(-*at, 0.0, kEndInsideMm) : 0.0;
      if (auto line = besideEnd(kerf, station_mm + (end.at_start ? short_mm : -short_mm))) {
        line->offset_mm -= line->slope * short_mm;
        at = lookAt(*line);
      }
      if (at) {
        const FlankMoments reach = reachOf(scene, stations[from].p_S_mm, half_width_mm, leg->brightness);
        out.found = true;
        out.gap_mm = std::abs(station_mm - scene.stationOf(end)) + reach.likely - *at;
        out.sigma_mm = std::hypot(endSigma(leg->sigma_mm, strip_mm, leg->brightness), reach.sigma);
        return out;
      }
    }
    const auto seen = [](const Caliper& c) { return c.found && !c.near_joint; };
    if (end.at_start) {
      from = static_cast<std::size_t>(std::find_if(kerf.calipers.begin(), kerf.calipers.end(), seen) -
                                      kerf.calipers.begin());
    } else {
      from = kerf.calipers.size() - 1 -
             static_cast<std::size_t>(std::find_if(kerf.calipers.rbegin(), kerf.calipers.rend(), seen) -
                                      kerf.calipers.rbegin());
    }
    if (from >= stations.size()) return out;
  }
  return out;
}

LineEnd measureClosure(const JointScene& scene, const EntityEnd& start) {
  const EntityKerf& kerf = (*scene.kerfs)[start.plan];
  LineEnd out{.unit = scene.unit, .entity = kerf.entity, .at_start = true, .gap_mm = kNan, .sigma_mm = kNan};
  const auto begin = legAt(kerf, 0.0, kLegFromMm);
  const auto finish = legAt(kerf, scene.plan->entities[start.plan].length_mm, kLegFromMm);
  if (!begin || !finish) return out;
  const double half_width_mm = 0.5 * (begin->half_width_mm + finish->half_width_mm);
  const double strip_mm = stripOf(half_width_mm, scene.calibration->pitchMm());
  const double brightness = std::min(begin->brightness, finish->brightness);
  const Eigen::Vector2d left(start.outward.y(), -start.outward.x());  // outward runs against the curve
  const double inside_mm = insideMm(scene.stationAt(start), half_width_mm);
  const auto look = [&](const KerfLeg& leg, const Eigen::Vector2d& outward) {
    return outlineMm(scene, {start.p_S_mm + leg.offset_mm * left, outward, strip_mm, brightness, inside_mm});
  };
  // Each end seen from its own side; where the kerf goes on there is no end to see.
  const auto before = look(*finish, -start.outward);
  const auto after = look(*begin, start.outward);
  out.found = true;
  out.sigma_mm =
      std::numbers::sqrt2 * endSigma(std::max(begin->sigma_mm, finish->sigma_mm), strip_mm, brightness);
  out.gap_mm = 0.0;
  if (before && after) {
    const FlankMoments reach = reachOf(scene, start.p_S_mm, half_width_mm, brightness);
    // Gap of two looks from opposite sides: the dark between them is -(before + after).
    out.gap_mm = std::max(0.0, 2.0 * reach.likely - *before - *after);
    // Where both overlap by more than the reach is uncertain by, there is no gap whatever the reach.
    const double overlap_mm = std::max(0.0, *before + *after - 2.0 * reach.likely);
    const double by_reach_mm = 2.0 * reach.sigma;
    out.sigma_mm = std::hypot(out.sigma_mm, std::clamp(2.0 * by_reach_mm - overlap_mm, 0.0, by_reach_mm));
  }
  return out;
}

}  // namespace kerfbench::vision
