// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/scan/kerf_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_pictures.h"
#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/kerf_tiles.h"
#include "hil/vision/marks/mark_misfit.h"
#include "hil/vision/scan/kerf_unit.h"
#include "hil/vision/scan/mosaic.h"
#include "hil/vision/scan/sight_pairs.h"
#include "hil/vision/scan/tile_contradictions.h"

namespace kerfbench::vision {
namespace {

/// What a unit that could not be placed leaves: every caliper not found.
void addUnseen(const KerfPlan& plan, int unit, KerfScan& scan) {
  for (const EntityPlan& entity : plan.entities) {
    EntityKerf kerf{unit, entity.entity, {}};
    for (const Station& s : entity.stations) {
      constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
      Caliper caliper{.u = s.u, .station_mm = s.station_mm, .p_S_mm = s.p_S_mm};
      caliper.offset_mm = caliper.sigma_mm = caliper.steady_sigma_mm = caliper.width_mm =
          caliper.width_sigma_mm = kNan;
      caliper.near_joint = s.near_corner;
      kerf.calipers.push_back(caliper);
    }
    scan.entities.push_back(std::move(kerf));
  }
}

/// Chance that any mark of a good sheet is taken for one that lies elsewhere, in one run.
constexpr double kFalseMisfits = 5e-4;
/// What a picture may leave of a mark's place, besides noise; one standard deviation per axis.
constexpr double kLeastMark_mm = 1e-3;

/// A place on the sheet for people.
std::string shown(const Eigen::Vector2d& p_mm) {
  return fmt::format("x {} y {} mm", base::hundredths(p_mm.x()), base::hundredths(p_mm.y()));
}

/// A mark that contradicts the others: somebody measured from it, or the print is not what the scenario says.
std::optional<std::string> misfitProblem(const UnitPlace& place, const PrintLayout& print,
                                         const CameraCalibration& calibration) {
  if (place.seen.size() < 2) return std::nullopt;
  std::vector<MarkPair> pairs;
  for (const SeenMark& mark : place.seen) {
    pairs.push_back(mark.pair);
    pairs.back().sigma_mm = std::hypot(mark.pair.sigma_mm, calibration.map_u_mm, kLeastMark_mm);
  }
  const auto misfit = worstMisfit(pairs, kFalseMisfits / print.units);
  if (!misfit) return std::nullopt;
  const std::string allowed = fmt::format("what print, table and camera allow is {:.4f} mm", misfit->most_mm);
  if (pairs.size() < 4)
    return fmt::format(
        "its {} registration marks lie to each other {:.4f} mm off from how the print has them; {}",
        pairs.size(), misfit->off_mm, allowed);
  const std::size_t mark = place.seen[misfit->pair].mark;
  return fmt::format("registration mark {} ({}) lies {:.4f} mm from where the {} others put it; {}", mark + 1,
                     shown(print.marks[mark].p_SM_mm), misfit->off_mm, pairs.size() - 1, allowed);
}

/// Evidence that contradicts itself.
std::string problemOf(const TileContradictions& found) {
  return fmt::format(
      "pictures contradict each other at {} of {} places that two of them show: at {} the light differs, at "
      "{} "
      "the place of the kerf; the first is E{} at {}, in its pictures {} and {}",
      found.count(), found.compared, found.light, found.place, found.entity, shown(found.p_S_mm),
      found.tile + 1, found.other + 1);
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

Eigen::Vector2d centreOf(const std::vector<RegistrationMark>& marks) {
  Eigen::Vector2d sum_mm = Eigen::Vector2d::Zero();
  for (const RegistrationMark& mark : marks) sum_mm += mark.p_SM_mm;
  return marks.empty() ? sum_mm : Eigen::Vector2d(sum_mm / static_cast<double>(marks.size()));
}

/// Shown around the drawing, as a share of its size.
constexpr double kMosaicMargin = 0.03;

/// What the units of a sheet are scanned for, and with what.
struct ScanJob {
  const KerfPlan& plan;
  const CameraCalibration& calibration;
  const PrintLayout& print;
  const KerfScanOptions& options;
  Eigen::AlignedBox2d box_S_mm;  ///< The drawing.

  /// Keeps the picture of this unit if it is the worst so far.
  void keepMosaic(const TileIndex& index, const PlaneMotion& X_TS, int unit, KerfScan& scan) const {
    if (options.mosaic_px <= 0 || box_S_mm.isEmpty() || !(box_S_mm.sizes().maxCoeff() > 0.0)) return;
    if (scan.mosaic.image != nullptr && badnessOf(scan, unit) <= badnessOf(scan, scan.mosaic.unit)) return;
    const double margin_mm = kMosaicMargin * box_S_mm.sizes().maxCoeff();
    Eigen::AlignedBox2d shown_mm = box_S_mm;
    shown_mm.extend(box_S_mm.min() - Eigen::Vector2d::Constant(margin_mm));
    shown_mm.extend(box_S_mm.max() + Eigen::Vector2d::Constant(margin_mm));
    scan.mosaic = mosaicOf(index, calibration, {unit, X_TS, shown_mm, options.mosaic_px}, options.threads);
  }

  /// Scans one unit in all of its tiles.
  void scanUnit(std::vector<camera::KerfTile> tiles, int unit, KerfScan& scan) const {
    const UnitPictures pictures =
        viewUnit(std::move(tiles), unit, print, calibration, options, scan.problems);
    const TileIndex index(pictures.views, calibration);
    // In one tile, kerfs and marks are where they are wherever the table stopped.
    KerfScanOptions unit_options = options;
    if (pictures.views.size() < 2)
      unit_options.table_sigma_mm = 0.0;
    else
      unit_options.scale_sigma = std::hypot(options.scale_sigma, options.table_scale_sigma);
    scan.table_sigma_mm = std::max(scan.table_sigma_mm, unit_options.table_sigma_mm);
    scan.scale_sigma = std::max(scan.scale_sigma, unit_options.scale_sigma);
    const double mark_sigma_mm = std::hypot(unit_options.table_sigma_mm, options.print_sigma_mm);
    const std::optional<UnitPlace> place =
        placeUnit(pictures.views, index, {unit, &print, mark_sigma_mm}, calibration, scan.problems);
    if (!place) {
      addUnseen(plan, unit, scan);
      return;
    }
    if (const auto problem = misfitProblem(*place, print, calibration))
      scan.problems.push_back("unit " + std::to_string(unit) + ": " + *problem);
    scan.mark_residual_mm = std::max(scan.mark_residual_mm, place->residual_mm);
    scan.units.push_back({unit, place->X_TS.shift_mm, place->X_TS.angle_rad, place->covariance,
                          place->residual_mm, place->marks, centreOf(print.marks)});
    const OverlapScene overlaps{pictures.views, index, place->X_TS, calibration, options};
    const SightFit sight = sightDepths(sightPairs(plan, overlaps), pictures.views.size(),
                                       options.board_thickness_mm, options.table_sigma_mm);
    const TileContradictions contradictions = compareTiles(plan, overlaps, sight.depths);
    if (contradictions.count() > 0)
      scan.problems.push_back("unit " + std::to_string(unit) + ": " + problemOf(contradictions));
    if (!(scan.tile_misfit_mm > sight.misfit_mm)) scan.tile_misfit_mm = sight.misfit_mm;
    const UnitScan unit_scan(calibration, plan, unit_options,
                             {pictures.views, index, unit, place->X_TS, pictures.blur, sight.depths,
                              scan.units.back().marks_centre_S_mm});
    unit_scan.cuts(scan);
    unit_scan.strays(scan);
    keepMosaic(index, place->X_TS, unit, scan);
  }
};

}  // namespace

KerfScan scanKerf(camera::TileSource& tiles, const CameraCalibration& calibration, const PrintLayout& print,
                  const dieline::Dieline& dieline, const KerfScanOptions& options) {
  if (!(options.station_pitch_mm > 0.0) || !(options.reach_mm > 0.0) || !(options.open_gray > 0.0) ||
      !(options.beam_radius_mm >= 0.0) || !(options.board_thickness_mm >= 0.0) ||
      !(options.table_sigma_mm >= 0.0) || !(options.table_scale_sigma >= 0.0) ||
      !(options.scale_sigma >= 0.0) || !(options.open_gray_sigma >= 0.0) ||
      !(options.print_sigma_mm >= 0.0)) {
    throw std::invalid_argument(
        "kerf scan: station_pitch_mm, reach_mm and open_gray must be > 0, beam_radius_mm, "
        "board_thickness_mm, table_sigma_mm, table_scale_sigma, scale_sigma, open_gray_sigma and "
        "print_sigma_mm "
        ">= 0");
  }
  const KerfPlan plan = planKerf(dieline, options);
  const ScanJob job{plan, calibration, print, options, dieline.bounds()};
  KerfScan scan;
  scan.tile_misfit_mm = std::numeric_limits<double>::quiet_NaN();
  std::set<int> done;
  UnitTiles source(tiles, calibration);
  for (;;) {
    std::vector<camera::KerfTile> of_unit = source.next();
    if (of_unit.empty()) break;
    const int unit = of_unit.front().unit;
    if (unit < 0 || unit >= print.units || !done.insert(unit).second) {
      scan.problems.push_back("unit " + std::to_string(unit) +
                              ": tiles that belong to no unit, or come out of order");
      continue;
    }
    job.scanUnit(std::move(of_unit), unit, scan);
  }
  for (int unit = 0; unit < print.units; ++unit) {
    if (done.contains(unit)) continue;
    scan.problems.push_back("unit " + std::to_string(unit) + ": no tile");
    addUnseen(plan, unit, scan);
  }
  keepWorstPatches(scan, options.patches);
  return scan;
}

}  // namespace kerfbench::vision
