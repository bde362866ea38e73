// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/scan/sight_pairs.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr double kPairPitch_mm = 1.0;
constexpr double kSameMark_mm = 0.5;

std::size_t indexOf(const OverlapScene& scene, const TileView* view) {
  return static_cast<std::size_t>(view - scene.tiles.data());
}

Vector2d slopeIn(const OverlapScene& scene, const TileView& view, const Vector2d& p_T_mm) {
  return scene.calibration.sightSlope(p_T_mm - view.tile.p_TV_mm);
}

std::optional<SightPair> pairAt(const EntityPlan& plan, const Station& station, const OverlapScene& scene,
                                double border_px) {
  const Vector2d p_T_mm = scene.X_TS * station.p_S_mm;
  const std::vector<const TileView*> seeing = scene.index.seeing(p_T_mm, border_px);
  if (seeing.size() < 2) return std::nullopt;
  SightPair pair{.form = formOf(plan.process), .tile = indexOf(scene, seeing.front())};
  pair.normal = scene.X_TS.rotation() * Vector2d(-station.tangent.y(), station.tangent.x());
  const Vector2d here = slopeIn(scene, *seeing.front(), p_T_mm);
  const TileView* other = nullptr;
  for (const TileView* view : seeing) {
    const double slope = (slopeIn(scene, *view, p_T_mm) - here).dot(pair.normal);
    if (view == seeing.front() || (other != nullptr && std::abs(slope) <= std::abs(pair.slope))) continue;
    other = view;
    pair.slope = slope;
  }
  pair.other = indexOf(scene, other);
  const CaliperWindow window = windowOf(station, plan, scene.options.reach_mm);
  const KerfReading one = loneReading(scene, *seeing.front(), window);
  const KerfReading two = loneReading(scene, *other, window);
  if (!one.found || !two.found) return std::nullopt;
  pair.apart_mm = two.offset_mm - one.offset_mm;
  pair.sigma_mm = std::hypot(one.noise_mm, two.noise_mm);
  if (!std::isfinite(pair.sigma_mm)) return std::nullopt;
  return pair;
}

void addMarks(const OverlapScene& scene, std::vector<SightPair>& pairs) {
  for (std::size_t a = 0; a < scene.tiles.size(); ++a) {
    for (std::size_t b = a + 1; b < scene.tiles.size(); ++b) {
      for (const FoundMark& mark : scene.tiles[a].marks) {
        const Vector2d here = scene.tiles[a].tile.p_TV_mm + mark.p_mm;
        for (const FoundMark& same : scene.tiles[b].marks) {
          const Vector2d apart = scene.tiles[b].tile.p_TV_mm + same.p_mm - here;
          if (apart.norm() > kSameMark_mm) continue;
          for (const Vector2d& axis : {Vector2d(1.0, 0.0), Vector2d(0.0, 1.0)}) {
            pairs.push_back({.tile = a,
                             .other = b,
                             .normal = axis,
                             .apart_mm = apart.dot(axis),
                             .sigma_mm = std::hypot(mark.sigma_mm, same.sigma_mm)});
          }
        }
      }
    }
  }
}

}  // namespace

Profile loneProfile(const OverlapScene& scene, const TileView& view, const CaliperWindow& window) {
  Profile profile;
  readProfile(view, scene.calibration, scene.X_TS, window, {}, profile);
  return profile;
}

KerfReading loneReading(const OverlapScene& scene, const TileView& view, const CaliperWindow& window) {
  return measureKerf(loneProfile(scene, view, window), scene.options.open_gray);
}

std::vector<SightPair> sightPairs(const KerfPlan& plan, const OverlapScene& scene) {
  std::vector<SightPair> pairs;
  if (scene.tiles.size() < 2) return pairs;
  const double border_px = caliperBorderPx(scene.options.reach_mm, scene.calibration.pitchMm());
  for (const EntityPlan& entity : plan.entities) {
    double next_mm = 0.0;
    for (const Station& station : entity.stations) {
      if (station.station_mm < next_mm || station.near_corner || !entity.hidden(station).empty()) continue;
      const auto pair = pairAt(entity, station, scene, border_px);
      if (!pair) continue;
      pairs.push_back(*pair);
      next_mm = station.station_mm + kPairPitch_mm;
    }
  }
  addMarks(scene, pairs);
  return pairs;
}

}  // namespace kerfbench::vision
