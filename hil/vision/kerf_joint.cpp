// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_joint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "hil/vision/corner_shape.h"
#include "hil/vision/kerf_leg.h"
#include "hil/vision/kerf_outline.h"
#include "hil/vision/kerf_profile.h"

namespace kerfbench::hil {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Either leg is looked at as if both ran over alike. Where one runs over alone by 60 um, 43 are seen of it
// and 24 of the other: the longer is read too short by about the difference.
constexpr double kUneven = 0.95;
constexpr double kUnevenSigma = 0.2;
// A difference of so few sigmas may be noise; then it is counted as uncertainty alone.
constexpr double kUnevenSigmas = 5.0;
constexpr double kUnevenUnseen = 0.5;
// What the outline's model leaves, measured: tests/hil/vision, kerf_joint_test and kerf_corner_test.
constexpr double kEndMm = 0.0015;
constexpr double kFaintEndMm = 0.0018;
constexpr double kCornerMm = 0.0009;
constexpr double kFaintCornerMm = 0.0018;
constexpr double kThrough = 0.75;  // brightness
constexpr double kLegFromMm = 0.3;
constexpr double kClearFrom_rad = 1.0;
constexpr double kClearTo_rad = 2.0;
constexpr double kLegFromMostMm = 1.2;
constexpr double kBehindArcMm = 0.1;
constexpr double kEndInsideMm = 0.3;    // An end that is shorter is looked at from the last caliper.
constexpr double kReachMm = 0.8;        // of a look along a leg
constexpr double kStripWidths = 0.35;   // half the strip, in half kerfs
constexpr double kMostBeyondMm = 0.4;   // that a corner is cut or run over
constexpr double kLeastTurn_rad = 0.9;  // from where on a leg that runs over stands clear of the other
constexpr double kWindowMm = 0.1;       // half of what a caliper averages along the curve

/// A look along a leg or a bisector.
struct Look {
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d direction{Eigen::Vector2d::UnitX()};  ///< Outwards.
  double strip_mm{};
  double brightness{};
  double
      inside_mm{};  ///< Before p_S_mm, from where on the kerf is followed; 0: from the kerf that is nearest.
};

const TileView* tileFor(const JointScene& scene, const Eigen::Vector2d& p_S_mm) {
  const double border_px = (kReachMm + 0.1) / scene.calibration->pitchMm() * 1.05 + 4.0;
  return scene.tiles->best(*scene.X_TS * p_S_mm, border_px);
}

/// Gray of whole board around a point, in even light.
double boardAt(const JointScene& scene, const TileView& view, const Eigen::Vector2d& p_S_mm) {
  const Eigen::Vector2d pixel = scene.calibration->pixelFromPlane(*scene.X_TS * p_S_mm - view.tile.p_TV_mm);
  return view.background->at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())) / view.light.at(pixel);
}

/// Where the light falls below half way, first, going outwards.
std::optional<double> outlineMm(const JointScene& scene, const Look& look) {
  const TileView* view = tileFor(scene, look.p_S_mm);
  if (view == nullptr) return std::nullopt;
  const CaliperWindow window{.p_S_mm = look.p_S_mm,
                             .tangent = Eigen::Vector2d(look.direction.y(), -look.direction.x()),
                             .back_mm = look.strip_mm,
                             .ahead_mm = look.strip_mm,
                             .reach_mm = kReachMm};
  Profile profile;
  readProfile(*view, *scene.calibration, *scene.X_TS, window, {}, 0.0, profile);
  const std::size_t n = profile.size();
  const std::size_t middle = n / 2;
  const double board = boardAt(scene, *view, look.p_S_mm);
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

KerfOutline outlineOf(const JointScene& scene, const Eigen::Vector2d& p_S_mm, double half_width_mm,
                      double brightness) {
  const TileView* view = tileFor(scene, p_S_mm);
  return KerfOutline({.half_width_mm = half_width_mm,
                      .brightness = brightness,
                      .board_gray = view == nullptr ? 0.0 : boardAt(scene, *view, p_S_mm),
                      .open_gray = scene.options->open_gray,
                      .beam_radius_mm = scene.options->beam_radius_mm,
                      .pixel_mm = scene.calibration->pitchMm()});
}

/// How far a way goes beyond its corner whose outline reaches as far as was seen; < 0: inside of it.
double beyondMm(const KerfOutline& outline, const Eigen::Vector2d& direction, double strip_mm, BeamWay way,
                double seen_mm) {
  double low = -kMostBeyondMm;
  double high = kMostBeyondMm;
  for (int i = 0; i < 12; ++i) {
    way.beyond_mm = 0.5 * (low + high);
    (outline.reachMm(direction, strip_mm, way) < seen_mm ? low : high) = way.beyond_mm;
  }
  return 0.5 * (low + high);
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

const Station& stationAt(const JointScene& scene, const EntityEnd& end) {
  const std::vector<Station>& stations = scene.plan->entities[end.plan].stations;
  return end.at_start ? stations.front() : stations.back();
}

double stationOfEnd(const JointScene& scene, const EntityEnd& end) {
  return end.at_start ? 0.0 : scene.plan->entities[end.plan].length_mm;
}

}  // namespace

CornerKerf measureCorner(const JointScene& scene, const PlannedCorner& corner) {
  CornerKerf out{.unit = scene.unit,
                 .entity_in = scene.plan->entities[corner.in.plan].entity,
                 .entity_out = scene.plan->entities[corner.out.plan].entity,
                 .p_S_mm = corner.in.p_S_mm,
                 .turn_rad = corner.turn_rad,
                 .rounding_mm = kNan,
                 .overshoot_mm = kNan,
                 .deviation_mm = kNan,
                 .sigma_mm = kNan};
  // There the other leg is out of a caliper's window.
  const bool clear = std::abs(corner.turn_rad) > kClearFrom_rad && std::abs(corner.turn_rad) < kClearTo_rad;
  const auto legOf = [&](const EntityEnd& end, double from_mm) {
    return legAt((*scene.kerfs)[end.plan], stationOfEnd(scene, end), from_mm, clear);
  };
  auto in = legOf(corner.in, kLegFromMm);
  auto on = legOf(corner.out, kLegFromMm);
  if (!in || !on) return out;
  const double half_width_mm = 0.5 * (in->half_width_mm + on->half_width_mm);
  const double brightness = std::min(in->brightness, on->brightness);
  const double strip_mm = stripOf(half_width_mm, scene.calibration->pitchMm());
  const KerfOutline outline = outlineOf(scene, out.p_S_mm, half_width_mm, brightness);
  const BeamWay way{corner.tangent_in, corner.tangent_out, 0.0};
  CornerShape shape{.tangent_in = corner.tangent_in, .tangent_out = corner.tangent_out};
  // From the vertex that is known so far.
  const auto beyond = [&](const Eigen::Vector2d& direction, double inside_mm) -> std::optional<double> {
    const Eigen::Vector2d p_S_mm = out.p_S_mm + shape.vertex_mm;
    const auto at = outlineMm(scene, {p_S_mm, direction, strip_mm, brightness, inside_mm});
    if (!at) return std::nullopt;
    return beyondMm(outline, direction, strip_mm, way, *at);
  };
  const Eigen::Vector2d outwards = (corner.tangent_in - corner.tangent_out).normalized();
  // Where an arc cuts the corner from afar, the legs begin behind it.
  const double arc_mm = arcLegMm(corner.turn_rad, std::max(0.0, -beyond(outwards, 0.0).value_or(0.0)));
  const double from_mm = std::clamp(arc_mm + kBehindArcMm, kLegFromMm, kLegFromMostMm);
  if (const auto leg = legOf(corner.in, from_mm)) in = leg;
  if (const auto leg = legOf(corner.out, from_mm)) on = leg;
  // An entity's left is the way's, or its right where the way runs against the entity.
  shape.vertex_mm = vertexOf(corner.tangent_in, corner.in.at_start ? -in->offset_mm : in->offset_mm,
                             corner.tangent_out, corner.out.at_start ? on->offset_mm : -on->offset_mm);
  const auto bisector = beyond(outwards, 0.0);
  if (!bisector) return out;
  out.found = true;
  shape.rounding_mm = std::max(0.0, -*bisector);
  if (std::abs(corner.turn_rad) < kLeastTurn_rad) {
    shape.over_in_mm = shape.over_out_mm = std::max(0.0, *bisector);
  } else {
    const auto run = [&](const Eigen::Vector2d& direction, const EntityEnd& end) {
      const auto over = beyond(direction, insideMm(stationAt(scene, end), half_width_mm));
      return std::max(0.0, over.value_or(0.0));
    };
    shape.over_in_mm = run(corner.tangent_in, corner.in);
    shape.over_out_mm = run(-corner.tangent_out, corner.out);
  }
  const double look_sigma_mm = lookSigma(std::max(in->sigma_mm, on->sigma_mm), strip_mm,
                                         brightness > kThrough ? kCornerMm : kFaintCornerMm);
  const double uneven_mm = std::abs(shape.over_in_mm - shape.over_out_mm);
  const bool one_leg = uneven_mm > kUnevenSigmas * look_sigma_mm;
  if (one_leg)
    (shape.over_in_mm > shape.over_out_mm ? shape.over_in_mm : shape.over_out_mm) += kUneven * uneven_mm;
  out.rounding_mm = shape.rounding_mm;
  out.overshoot_mm = std::max(shape.over_in_mm, shape.over_out_mm);
  out.deviation_mm = deviationMm(shape);
  // How well the legs tell their vertex, along the bisector.
  const double vertex_sigma_mm =
      0.5 * std::hypot(in->offset_sigma_mm, on->offset_sigma_mm) / std::cos(0.5 * corner.turn_rad);
  out.sigma_mm =
      std::hypot(vertex_sigma_mm, look_sigma_mm, (one_leg ? kUnevenSigma : kUnevenUnseen) * uneven_mm);
  return out;
}

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
    // The kerf may lie beside the nominal curve: look along the kerf. Where it ends tells where exactly.
    const auto lookAt = [&](double offset_mm) {
      const Eigen::Vector2d aside = offset_mm * Eigen::Vector2d(-tangent.y(), tangent.x());
      const double inside_mm = std::min(kEndInsideMm, insideMm(stations[from], half_width_mm));
      return outlineMm(scene, {stations[from].p_S_mm + aside, outward, strip_mm, leg->brightness, inside_mm});
    };
    if (leg) {
      const double first_mm = besideEnd(kerf, station_mm).value_or(leg->offset_mm);
      auto at = lookAt(first_mm);
      const double short_mm = at ? std::clamp(-*at, 0.0, kEndInsideMm) : 0.0;
      if (const auto offset_mm = besideEnd(kerf, station_mm + (end.at_start ? short_mm : -short_mm)))
        at = lookAt(*offset_mm);
      if (at) {
        const KerfOutline outline = outlineOf(scene, stations[from].p_S_mm, half_width_mm, leg->brightness);
        out.found = true;
        out.gap_mm = std::abs(station_mm - stationOfEnd(scene, end)) +
                     outline.reachMm(outward, strip_mm, {.tangent_in = outward}) - *at;
        out.sigma_mm = endSigma(leg->sigma_mm, strip_mm, leg->brightness);
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
  const double inside_mm = insideMm(stationAt(scene, start), half_width_mm);
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
    const KerfOutline outline = outlineOf(scene, start.p_S_mm, half_width_mm, brightness);
    const double reach_mm = outline.reachMm(start.outward, strip_mm, {.tangent_in = start.outward});
    // Both look from opposite sides: the dark between them is -(before + after).
    out.gap_mm = std::max(0.0, 2.0 * reach_mm - *before - *after);
  }
  return out;
}

}  // namespace kerfbench::hil
