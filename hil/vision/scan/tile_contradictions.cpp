// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/scan/tile_contradictions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "hil/base/parallel.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

/// A kerf lies elsewhere beyond so many standard deviations of what may part two pictures. Good pictures stay
/// within 4 of them: two micrometres by grid and blur on the scenarios in fixtures.
constexpr double kSigmas = 6.0;
/// What grid of pixels, blur and model of the flanks may part two pictures by; one standard deviation.
constexpr double kLeastApart_mm = 1e-3;
/// The depth at which a kerf is seen is not the same at all angles; share of the board's thickness.
constexpr double kDepthShare = 0.04;
/// The light of a kerf in two pictures: the weaker is at least this share of the stronger, or less weaker
/// than the next figure. Good pictures of fixtures show 0.66 and 0.05 at worst, at the ends of a
/// perforation's teeth.
constexpr double kLeastLightShare = 0.5;
constexpr double kMostLightApart = 0.08;

/// Share of a caliper's reach within which a kerf is surely the one that lies nearest in any picture. One
/// that lies farther off, of a job that is cut elsewhere, may be cut off by the caliper's end in one of two
/// pictures.
constexpr double kNearShare = 0.5;

/// Brightness from which on a line is more than a trace, whose place scatters by more than its pixels tell.
constexpr double kTrace = 0.15;

bool isNear(const KerfReading& reading, const KerfScanOptions& options) {
  return reading.found && std::abs(reading.offset_mm) <= kNearShare * options.reach_mm;
}

bool isWeaker(double brightness, double than) {
  return than - brightness > kMostLightApart && brightness < kLeastLightShare * than;
}

/// A station of a line in one picture.
class StationInView {
 public:
  StationInView(const OverlapScene& scene, const EntityPlan& entity, std::size_t station,
                const TileView& view)
      : scene_(scene), entity_(entity), station_(station), view_(view), reading_(read(station)) {}

  [[nodiscard]] const KerfReading& reading() const { return reading_; }
  [[nodiscard]] Profile profile() const {
    return loneProfile(scene_, view_, windowOf(entity_.stations[station_], entity_, scene_.options.reach_mm));
  }

  /// The least and the most light from the station before this one to the one behind it.
  struct Light {
    double least{}, most{};
  };
  [[nodiscard]] Light lightAround() const {
    const double before = lightAfter(entity_.stations.size() - 1);
    const double behind = lightAfter(1);
    return {std::min({before, reading_.brightness, behind}), std::max({before, reading_.brightness, behind})};
  }

  /// The farthest places of the kerf from the station before this one to the one behind it, mm across the
  /// line.
  struct Places {
    double least_mm{}, most_mm{};
    [[nodiscard]] bool hold(double offset_mm, double within_mm) const {
      return offset_mm > least_mm - within_mm && offset_mm < most_mm + within_mm;
    }
  };
  [[nodiscard]] Places placesAround() const {
    Places places{reading_.offset_mm, reading_.offset_mm};
    for (const std::size_t steps : {entity_.stations.size() - 1, std::size_t{1}}) {
      const std::optional<std::size_t> other = stationAfter(steps);
      if (!other) continue;
      const KerfReading beside = read(*other);
      if (!isNear(beside, scene_.options)) continue;
      places.least_mm = std::min(places.least_mm, beside.offset_mm);
      places.most_mm = std::max(places.most_mm, beside.offset_mm);
    }
    return places;
  }

 private:
  [[nodiscard]] KerfReading read(std::size_t station) const {
    return loneReading(scene_, view_, windowOf(entity_.stations[station], entity_, scene_.options.reach_mm));
  }
  /// The station so many stations on, around the line; there is none beyond the ends of an open one.
  [[nodiscard]] std::optional<std::size_t> stationAfter(std::size_t steps) const {
    const std::size_t other = (station_ + steps) % entity_.stations.size();
    const bool beyond = !entity_.closed && (steps == 1 ? other == 0 : station_ == 0);
    if (beyond) return std::nullopt;
    return other;
  }
  [[nodiscard]] double lightAfter(std::size_t steps) const {
    const std::optional<std::size_t> other = stationAfter(steps);
    return other ? read(*other).brightness : 0.0;
  }

  const OverlapScene& scene_;
  const EntityPlan& entity_;
  std::size_t station_;
  const TileView& view_;
  KerfReading reading_;
};

/// Where a cut begins or ends, the light changes from nothing to all within a few stations, and two pictures
/// whose table stopped a little apart show each of these differently. Only light that the other picture does
/// not show at the stations beside it either contradicts.
bool lightContradicts(const StationInView& one, const StationInView& two, const KerfScanOptions& options) {
  const bool one_weaker = one.reading().brightness < two.reading().brightness;
  const StationInView& weaker = one_weaker ? one : two;
  const StationInView& stronger = one_weaker ? two : one;
  const double least = weaker.reading().brightness;
  const double most = stronger.reading().brightness;
  if (!isNear(stronger.reading(), options) || !isWeaker(least, most)) return false;
  return isWeaker(least, stronger.lightAround().least) || isWeaker(weaker.lightAround().most, most);
}

/// Light at a place across a line, over that of the board; between two samples as on a straight line.
double lightOver(const Profile& profile, double base_gray, double across_mm) {
  const double at = (across_mm - profile.first_mm) / profile.step_mm;
  const double last = static_cast<double>(profile.size() - 1);
  const auto i = static_cast<std::size_t>(std::clamp(std::floor(at), 0.0, last - 1.0));
  const double t = std::clamp(at - static_cast<double>(i), 0.0, 1.0);
  return std::lerp(profile.gray[i], profile.gray[i + 1], t) - base_gray;
}

/// Light that one picture shows and the other not, from flank to flank of both kerfs, mm of a kerf in full
/// light. `expected_mm`: how far the same kerf lies farther on in the second picture.
double changedLight(const StationInView& first, const StationInView& second, double expected_mm) {
  const KerfReading& one = first.reading();
  const KerfReading& two = second.reading();
  const Profile a = first.profile();
  const Profile b = second.profile();
  const double two_mm = two.offset_mm - expected_mm;
  const double from_mm = std::min(one.offset_mm - 0.5 * one.width_mm, two_mm - 0.5 * two.width_mm);
  const double to_mm = std::max(one.offset_mm + 0.5 * one.width_mm, two_mm + 0.5 * two.width_mm);
  double changed = 0.0;
  const int steps = static_cast<int>((to_mm - from_mm + 2.0 * a.pixel_mm) / a.step_mm);
  for (int i = 0; i <= steps; ++i) {
    const double x_mm = from_mm - a.pixel_mm + i * a.step_mm;
    changed += a.step_mm *
               std::abs(lightOver(a, one.base_gray, x_mm) - lightOver(b, two.base_gray, x_mm + expected_mm));
  }
  return changed / std::max(one.top_gray - one.base_gray, two.top_gray - two.base_gray);
}

/// Kerfs that run together are read apart in one picture and as one in the other, by the little that noise
/// and grid add to the light between them: the middles are far apart, and the light is the same. A kerf that
/// lies elsewhere leaves as much of one picture dark as it lies aside, or all of its width, and lights up as
/// much of it on its other side.
bool isReadOtherwise(const StationInView& first, const StationInView& second, double expected_mm) {
  const KerfReading& one = first.reading();
  const KerfReading& two = second.reading();
  const double apart_mm = std::abs(two.offset_mm - one.offset_mm - expected_mm);
  return changedLight(first, second, expected_mm) < std::min({apart_mm, one.width_mm, two.width_mm});
}

/// Where kerfs cross, or lie side by side, a caliper goes over from one to the other between two stations,
/// and in two pictures not at the same. Only a place that the other picture does not show at the stations
/// beside it either contradicts. `slope`: CameraCalibration::sightSlope across the kerf in the second picture
/// less that in the first.
bool placeContradicts(const StationInView& first, const StationInView& second, double slope,
                      const SightDepth& depth, const KerfScanOptions& options) {
  const KerfReading& one = first.reading();
  const KerfReading& two = second.reading();
  if (!isNear(one, options) || !isNear(two, options)) return false;
  if (std::min(one.brightness, two.brightness) < kTrace) return false;
  const double noise_mm = std::hypot(one.noise_mm, two.noise_mm, kLeastApart_mm);
  if (!std::isfinite(noise_mm)) return false;
  const double by_depth_mm =
      std::abs(slope) * std::hypot(depth.sigma_mm, kDepthShare * options.board_thickness_mm);
  const double sigma_mm = std::hypot(noise_mm, by_depth_mm, std::numbers::sqrt2 * options.table_sigma_mm);
  const double expected_mm = -slope * depth.mm;
  const double apart_mm = kSigmas * sigma_mm;
  if (!(std::abs(two.offset_mm - one.offset_mm - expected_mm) > apart_mm)) return false;
  if (first.placesAround().hold(two.offset_mm - expected_mm, apart_mm) &&
      second.placesAround().hold(one.offset_mm + expected_mm, apart_mm)) {
    return false;
  }
  return !isReadOtherwise(first, second, expected_mm);
}

TileContradictions compareAlong(const EntityPlan& entity, const OverlapScene& scene,
                                const SightDepths& depths) {
  TileContradictions out;
  const double border_px = caliperBorderPx(scene.options.reach_mm, scene.calibration.pitchMm());
  const SightDepth& depth = depths.at(static_cast<std::size_t>(formOf(entity.process)));
  for (std::size_t s = 0; s < entity.stations.size(); ++s) {
    const Station& station = entity.stations[s];
    if (station.near_corner || !entity.hidden(station).empty()) continue;
    const Vector2d p_T_mm = scene.X_TS * station.p_S_mm;
    const std::vector<const TileView*> seeing = scene.index.seeing(p_T_mm, border_px);
    if (seeing.size() < 2) continue;
    const Vector2d normal = scene.X_TS.rotation() * Vector2d(-station.tangent.y(), station.tangent.x());
    const auto slopeIn = [&](const TileView& view) {
      return scene.calibration.sightSlope(p_T_mm - view.tile.p_TV_mm).dot(normal);
    };
    const StationInView used(scene, entity, s, *seeing.front());
    for (std::size_t i = 1; i < seeing.size(); ++i) {
      const StationInView other(scene, entity, s, *seeing[i]);
      const double slope = slopeIn(*seeing[i]) - slopeIn(*seeing.front());
      ++out.compared;
      const bool light = lightContradicts(used, other, scene.options);
      if (!light && !placeContradicts(used, other, slope, depth, scene.options)) continue;
      if (out.count() == 0) {
        out.entity = entity.entity;
        out.p_S_mm = station.p_S_mm;
        out.tile = static_cast<std::size_t>(seeing.front() - scene.tiles.data());
        out.other = static_cast<std::size_t>(seeing[i] - scene.tiles.data());
      }
      ++(light ? out.light : out.place);
    }
  }
  return out;
}

}  // namespace

TileContradictions compareTiles(const KerfPlan& plan, const OverlapScene& scene, const SightDepths& depths) {
  TileContradictions all;
  if (scene.tiles.size() < 2) return all;
  std::vector<TileContradictions> along(plan.entities.size());
  base::forEachIndex(along.size(), scene.options.threads,
                     [&](std::size_t e) { along[e] = compareAlong(plan.entities[e], scene, depths); });
  for (TileContradictions& entity : along) {
    entity.compared += all.compared;
    if (all.count() == 0) {
      all = entity;
      continue;
    }
    all.compared = entity.compared;
    all.light += entity.light;
    all.place += entity.place;
  }
  return all;
}

}  // namespace kerfbench::vision
