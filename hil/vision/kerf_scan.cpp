// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/vision/kerf_caliper.h"
#include "hil/vision/kerf_plan.h"
#include "hil/vision/kerf_stray.h"
#include "hil/vision/kerf_tiles.h"

namespace kerfbench::hil {
namespace {

constexpr std::size_t kTilesPerBatch = 8;
constexpr int kPatchPx = 80;
constexpr double kBorderPx = 4.0;  // what interpolation and the lines beside each other need

/// Hands out the tiles of one unit after the other.
class UnitTiles {
 public:
  UnitTiles(TileSource& source, const CameraCalibration& calibration)
      : source_(source), calibration_(calibration) {}

  std::vector<KerfTile> next() {
    std::vector<KerfTile> unit;
    for (;;) {
      if (pending_.empty()) {
        pending_ = source_.nextBatch(kTilesPerBatch);
        if (pending_.empty()) return unit;
        for (const KerfTile& tile : pending_) {
          if (tile.image.width != calibration_.width_px || tile.image.height != calibration_.height_px) {
            throw std::invalid_argument("a kerf tile of unit " + std::to_string(tile.unit) +
                                        " has not the size that the camera is calibrated for");
          }
        }
        std::reverse(pending_.begin(), pending_.end());
      }
      if (!unit.empty() && pending_.back().unit != unit.front().unit) return unit;
      unit.push_back(std::move(pending_.back()));
      pending_.pop_back();
    }
  }

 private:
  TileSource& source_;
  const CameraCalibration& calibration_;
  std::vector<KerfTile> pending_;  ///< Last one first.
};

struct Worst {
  double offset_mm{};  ///< Magnitude.
  const EntityPlan* plan{};
  const Station* station{};
};

std::optional<KerfPatch> cropPatch(const Worst& worst, int unit, const std::vector<TileView>& tiles,
                                   const CameraCalibration& calibration, const PlaneMotion& X_TS) {
  const Eigen::Vector2d p_T_mm = X_TS * worst.station->p_S_mm;
  const TileView* view = bestTile(tiles, calibration, p_T_mm, 0.0);
  if (view == nullptr) return std::nullopt;
  const LocalPixelMap map = calibration.localMap(p_T_mm - view->tile.p_TV_mm);
  const GrayImage& image = view->tile.image;
  const int width = std::min(kPatchPx, image.width);
  const int height = std::min(kPatchPx, image.height);
  const int left =
      std::clamp(static_cast<int>(std::lround(map.pixel.x())) - width / 2, 0, image.width - width);
  const int top =
      std::clamp(static_cast<int>(std::lround(map.pixel.y())) - height / 2, 0, image.height - height);
  KerfPatch patch;
  patch.unit = unit;
  patch.entity = worst.plan->entity;
  patch.p_S_mm = worst.station->p_S_mm;
  patch.image = GrayImage(width, height);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) patch.image.at(c, r) = image.at(left + c, top + r);
  }
  patch.pixel_from_S.linear() = map.pixel_per_mm * X_TS.rotation();
  patch.pixel_from_S.translation() =
      map.pixel - Eigen::Vector2d(left, top) - patch.pixel_from_S.linear() * worst.station->p_S_mm;
  return patch;
}

/// Everything about one unit; the tiles are dropped afterwards.
class UnitScan {
 public:
  UnitScan(const CameraCalibration& calibration, const std::vector<EntityPlan>& plans,
           const KerfScanOptions& options, std::vector<TileView> tiles, int unit, const PlaneMotion& X_TS)
      : calibration_(calibration),
        plans_(plans),
        options_(options),
        tiles_(std::move(tiles)),
        unit_(unit),
        X_TS_(X_TS) {}

  void calipers(KerfScan& scan) const {
    std::vector<EntityKerf> kerfs(plans_.size());
    std::vector<std::size_t> unseen(plans_.size(), 0);
    const double border_px = (options_.reach_mm + 0.1) / calibration_.pitchMm() * 1.05 + kBorderPx;
    forEachIndex(plans_.size(), options_.threads, [&](std::size_t e) {
      const EntityPlan& plan = plans_[e];
      kerfs[e] = {unit_, plan.entity, {}};
      Profile profile;
      for (const Station& station : plan.stations) {
        Caliper caliper;
        caliper.u = station.u;
        caliper.station_mm = station.station_mm;
        caliper.p_S_mm = station.p_S_mm;
        caliper.near_joint = station.near_joint;
        caliper.offset_mm = std::numeric_limits<double>::quiet_NaN();
        caliper.width_mm = std::numeric_limits<double>::quiet_NaN();
        const TileView* view = bestTile(tiles_, calibration_, X_TS_ * station.p_S_mm, border_px);
        if (view == nullptr) {
          ++unseen[e];
        } else {
          readProfile(*view, calibration_, X_TS_, station, plan, options_.reach_mm, profile);
          measureKerf(profile, options_.open_gray, caliper);
        }
        kerfs[e].calipers.push_back(caliper);
      }
    });
    for (std::size_t e = 0; e < plans_.size(); ++e) {
      if (unseen[e] > 0) {
        scan.problems.push_back("unit " + std::to_string(unit_) + ": " + std::to_string(unseen[e]) + " of " +
                                std::to_string(plans_[e].stations.size()) + " calipers of E" +
                                std::to_string(plans_[e].entity) + " lie outside the tiles");
      }
    }
    patches(kerfs, scan);
    std::move(kerfs.begin(), kerfs.end(), std::back_inserter(scan.entities));
  }

  void strays(KerfScan& scan) const {
    std::vector<std::vector<StrayBox>> per_tile(tiles_.size());
    forEachIndex(tiles_.size(), options_.threads, [&](std::size_t t) {
      per_tile[t] = findStrays(tiles_[t], t, calibration_, X_TS_, plans_, options_.open_gray);
    });
    std::vector<StrayBox> boxes;
    for (const auto& some : per_tile) boxes.insert(boxes.end(), some.begin(), some.end());
    const std::vector<StrayCut> strays = mergeStrays(std::move(boxes), unit_, options_.stray_min_mm);
    scan.strays.insert(scan.strays.end(), strays.begin(), strays.end());
  }

 private:
  void patches(const std::vector<EntityKerf>& kerfs, KerfScan& scan) const {
    std::vector<Worst> worst;
    for (std::size_t e = 0; e < plans_.size(); ++e) {
      Worst here;
      for (std::size_t i = 0; i < kerfs[e].calipers.size(); ++i) {
        const Caliper& caliper = kerfs[e].calipers[i];
        if (!caliper.found || caliper.near_joint || std::abs(caliper.offset_mm) <= here.offset_mm) continue;
        here = {std::abs(caliper.offset_mm), &plans_[e], &plans_[e].stations[i]};
      }
      if (here.station != nullptr) worst.push_back(here);
    }
    std::stable_sort(worst.begin(), worst.end(),
                     [](const Worst& a, const Worst& b) { return a.offset_mm > b.offset_mm; });
    worst.resize(std::min(worst.size(), static_cast<std::size_t>(std::max(0, options_.patches))));
    for (const Worst& w : worst) {
      if (auto patch = cropPatch(w, unit_, tiles_, calibration_, X_TS_)) {
        scan.patches.push_back(std::move(*patch));
      }
    }
  }

  const CameraCalibration& calibration_;
  const std::vector<EntityPlan>& plans_;
  const KerfScanOptions& options_;
  std::vector<TileView> tiles_;
  int unit_;
  PlaneMotion X_TS_;
};

/// What a unit that could not be placed leaves: every caliper not found.
void addUnseen(const std::vector<EntityPlan>& plans, int unit, KerfScan& scan) {
  for (const EntityPlan& plan : plans) {
    EntityKerf kerf{unit, plan.entity, {}};
    for (const Station& s : plan.stations) {
      constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
      Caliper caliper{.u = s.u, .station_mm = s.station_mm, .p_S_mm = s.p_S_mm};
      caliper.offset_mm = caliper.sigma_mm = caliper.width_mm = caliper.width_sigma_mm = kNan;
      caliper.near_joint = s.near_joint;
      kerf.calipers.push_back(caliper);
    }
    scan.entities.push_back(std::move(kerf));
  }
}

/// Worst first, over all units; the offset is read back from the entities.
void keepWorstPatches(KerfScan& scan, int count) {
  const auto offset = [&](const KerfPatch& patch) {
    double worst = 0.0;
    for (const EntityKerf& kerf : scan.entities) {
      if (kerf.unit != patch.unit || kerf.entity != patch.entity) continue;
      for (const Caliper& c : kerf.calipers) {
        if (c.found && !c.near_joint) worst = std::max(worst, std::abs(c.offset_mm));
      }
    }
    return worst;
  };
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < scan.patches.size(); ++i) order.emplace_back(-offset(scan.patches[i]), i);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), static_cast<std::size_t>(std::max(0, count))));
  std::vector<KerfPatch> kept;
  for (const auto& [negative_offset, i] : order) kept.push_back(std::move(scan.patches[i]));
  scan.patches = std::move(kept);
}

}  // namespace

KerfScan scanKerf(TileSource& tiles, const CameraCalibration& calibration, const PrintLayout& print,
                  const Dieline& dieline, const KerfScanOptions& options) {
  if (!(options.station_pitch_mm > 0.0) || !(options.reach_mm > 0.0) || !(options.open_gray > 0.0)) {
    throw std::invalid_argument("kerf scan: station_pitch_mm, reach_mm and open_gray must be > 0");
  }
  const std::vector<EntityPlan> plans = planStations(dieline, options);
  std::vector<double> diameters_mm;
  for (const RegistrationMark& mark : print.marks) diameters_mm.push_back(mark.diameter_mm);
  std::sort(diameters_mm.begin(), diameters_mm.end());
  diameters_mm.erase(std::unique(diameters_mm.begin(), diameters_mm.end()), diameters_mm.end());

  KerfScan scan;
  std::set<int> done;
  UnitTiles source(tiles, calibration);
  for (;;) {
    std::vector<KerfTile> of_unit = source.next();
    if (of_unit.empty()) break;
    const int unit = of_unit.front().unit;
    if (unit < 0 || unit >= print.units || !done.insert(unit).second) {
      scan.problems.push_back("unit " + std::to_string(unit) +
                              ": tiles that belong to no unit, or come out of order");
      continue;
    }
    std::vector<TileView> views(of_unit.size());
    forEachIndex(of_unit.size(), options.threads, [&](std::size_t i) {
      views[i] = viewTile(std::move(of_unit[i]), calibration, diameters_mm);
    });
    const std::optional<UnitPlace> place = placeUnit(views, unit, print, calibration, scan.problems);
    if (!place) {
      addUnseen(plans, unit, scan);
      continue;
    }
    scan.mark_residual_mm = std::max(scan.mark_residual_mm, place->residual_mm);
    const UnitScan unit_scan(calibration, plans, options, std::move(views), unit, place->X_TS);
    unit_scan.calipers(scan);
    unit_scan.strays(scan);
  }
  for (int unit = 0; unit < print.units; ++unit) {
    if (done.contains(unit)) continue;
    scan.problems.push_back("unit " + std::to_string(unit) + ": no tile");
    addUnseen(plans, unit, scan);
  }
  keepWorstPatches(scan, options.patches);
  return scan;
}

}  // namespace kerfbench::hil
