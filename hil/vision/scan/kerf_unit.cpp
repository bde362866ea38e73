// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/scan/kerf_unit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/vision/corner/joint_scene.h"
#include "hil/vision/corner/kerf_corner.h"
#include "hil/vision/corner/kerf_joint.h"
#include "hil/vision/kerf/kerf_flank.h"
#include "hil/vision/kerf/kerf_stray.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kPatchPx = 80;
constexpr float kEvenly = 0.75F;
/// A slit with upright walls that is seen aslant looks narrower by thickness x slope; one that narrows
/// downwards by more does not. Half of that is taken, and this much of it is uncertain: a rectangle's.
constexpr double kNarrowing = 0.5;
constexpr double kNarrowingSigma = 0.289;

/// A crease fades out over the beam's radius: so near to where it ends, and so much darker than elsewhere,
/// the board's own light says as much of its place as the crease does.
constexpr double kFadeMm = 0.25;
constexpr double kFadedShare = 0.8;

struct Worst {
  double offset_mm{};  ///< Magnitude.
  const EntityPlan* plan{};
  const Station* station{};
};

std::optional<KerfPatch> cropPatch(const Worst& worst, int unit, const TileIndex& tiles,
                                   const CameraCalibration& calibration, const PlaneMotion& X_TS) {
  const Eigen::Vector2d p_T_mm = X_TS * worst.station->p_S_mm;
  const TileView* view = tiles.best(p_T_mm, 0.0);
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
  const auto cut_out = std::make_shared<GrayImage>(width, height);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) cut_out->at(c, r) = image.at(left + c, top + r);
  }
  patch.image = cut_out;
  patch.pixel_from_S.linear() = map.pixel_per_mm * X_TS.rotation();
  patch.pixel_from_S.translation() =
      map.pixel - Eigen::Vector2d(left, top) - patch.pixel_from_S.linear() * worst.station->p_S_mm;
  return patch;
}

/// Whether all of the profile that the own kerf may take is seen, and evenly: where the pixels thin out
/// across a flank, their mean place is not where they are counted.
bool seesOwn(const Profile& profile) {
  float least = std::numeric_limits<float>::infinity();
  float most = 0.0F;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double across_mm = profile.first_mm + static_cast<double>(i) * profile.step_mm;
    if (std::abs(across_mm) > kOwnMm) continue;
    least = std::min(least, profile.weight[i]);
    most = std::max(most, profile.weight[i]);
  }
  return least >= Profile::kLeastWeight && least >= kEvenly * most;
}

/// Slope of the kerf against the nominal curve, from the neighbours' offsets; 0 where one is missing.
double slopeAt(const EntityKerf& kerf, std::size_t i) {
  if (i == 0 || i + 1 >= kerf.calipers.size()) return 0.0;
  const Caliper& before = kerf.calipers[i - 1];
  const Caliper& after = kerf.calipers[i + 1];
  const double slope = (after.offset_mm - before.offset_mm) / (after.station_mm - before.station_mm);
  return std::isfinite(slope) ? slope : 0.0;
}

/// Leaves a crease's place open where it fades out: measureEnd() looks at its ends.
void leaveFadingEnds(const EntityPlan& plan, EntityKerf& kerf) {
  std::vector<double> brightness;
  for (const Caliper& c : kerf.calipers) {
    if (c.found && !c.near_joint) brightness.push_back(c.brightness);
  }
  if (brightness.empty()) return;
  const double faded = kFadedShare * medianOf(std::move(brightness));
  std::vector<double> ends_mm;
  if (!plan.closed) ends_mm = {0.0, plan.length_mm};
  for (const Caliper& c : kerf.calipers) {
    if (!c.found) ends_mm.push_back(c.station_mm);
  }
  for (Caliper& c : kerf.calipers) {
    const bool ends = std::ranges::any_of(
        ends_mm, [&](double end_mm) { return std::abs(c.station_mm - end_mm) <= kFadeMm; });
    if (c.found && ends && c.brightness < faded) c.near_joint = true;
  }
}

}  // namespace

struct UnitScan::Scratch {
  Profile profile;
};

void UnitScan::caliper(const EntityPlan& plan, const Station& station, const TileView& view, Scratch& scratch,
                       Caliper& out, KerfReading& reading) const {
  const CaliperWindow window = windowOf(station, plan, options_.reach_mm);
  const auto hidden = plan.hidden(station);
  readProfile(view, cameraFor(plan), X_TS_, window, {hidden, kHiddenMm}, scratch.profile);
  if (!hidden.empty() && !seesOwn(scratch.profile)) {
    out.near_joint = true;
    readProfile(view, cameraFor(plan), X_TS_, window, {}, scratch.profile);
  }
  reading = measureKerf(scratch.profile, options_.open_gray);
  out.found = reading.found;
  out.offset_mm = reading.offset_mm;
  out.width_mm = reading.width_mm;
  out.brightness = reading.brightness;
}

void UnitScan::measure(const EntityPlan& plan, EntityKerf& kerf, Measured& out) const {
  const double border_px = caliperBorderPx(options_.reach_mm, calibration_.pitchMm());
  Scratch scratch;
  kerf.calipers.reserve(plan.stations.size());
  for (const Station& station : plan.stations) {
    Caliper caliper{.u = station.u, .station_mm = station.station_mm, .p_S_mm = station.p_S_mm};
    caliper.near_joint = station.near_corner;
    caliper.offset_mm = caliper.sigma_mm = caliper.steady_sigma_mm = caliper.width_mm =
        caliper.width_sigma_mm = kNan;
    KerfReading reading;
    reading.noise_mm = reading.board_mm = kNan;
    const TileView* view = index_.best(X_TS_ * station.p_S_mm, border_px);
    if (view == nullptr) {
      ++out.unseen;
    } else {
      caliper.p_V_mm = X_TS_ * station.p_S_mm - view->tile.p_TV_mm;
      caliper.tile = static_cast<int>(std::distance(tiles_.data(), view));
      this->caliper(plan, station, *view, scratch, caliper, reading);
    }
    kerf.calipers.push_back(caliper);
    out.readings.push_back(reading);
    out.noise.pixels_mm.push_back(reading.noise_mm);
    out.noise.board_mm.push_back(reading.board_mm);
    out.windows.push_back(windowOnPixels(plan, station, view));
  }
  if (formOf(plan.process) == KerfForm::kShallow) leaveFadingEnds(plan, kerf);
  for (const Station& station : plan.light_stations) {
    Caliper caliper{.near_joint = station.near_corner};
    KerfReading reading;
    const TileView* view = index_.best(X_TS_ * station.p_S_mm, border_px);
    if (view == nullptr) continue;  // The calipers there say so.
    this->caliper(plan, station, *view, scratch, caliper, reading);
    kerf.light.push_back({station.station_mm, caliper.brightness, caliper.near_joint});
  }
}

FlankBelief UnitScan::beliefOf(const std::vector<EntityKerf>& kerfs, const std::vector<Measured>& measured,
                               bool by_creases) const {
  std::vector<SeenFlank> flanks;
  for (std::size_t e = 0; e < kerfs.size(); ++e) {
    const EntityPlan& plan = plan_.entities[e];
    if (plan.process != dieline::Process::kCut && !(by_creases && plan.process == dieline::Process::kCrease))
      continue;
    const SeenFlank flank =
        meanFlank(plan, measured[e].readings, {options_, calibration_.pitchMm(), blur_}, kerfs[e]);
    if (flank.query.half_width_mm > 0.0) flanks.push_back(flank);
  }
  return vision::beliefOf(flanks,
                          {.growth = options_.growth,
                           .law_sigma = options_.law_sigma,
                           .begin_sigma = options_.begin_sigma,
                           .beam_radius_mm = options_.beam_radius_mm,
                           .radius_share_sigma = options_.beam_radius_sigma,
                           .blur = blur_,
                           .open_sigma = options_.open_gray_sigma},
                          options_.threads);
}

void UnitScan::correct(const EntityPlan& plan, const FlankBelief& belief, EntityKerf& kerf,
                       Measured& out) const {
  const double pixel_mm = calibration_.pitchMm();
  correctFlankBias(plan, out.readings, {options_, pixel_mm, blur_}, belief, kerf, out.noise.model_mm);
  correctCurvatureBias(plan, blur_.px * pixel_mm, kerf);
  widen(plan, kerf);
  for (std::size_t i = 0; i < out.windows.size(); ++i)
    out.noise.grid_mm.push_back(out.windows[i].gridNoise_mm(slopeAt(kerf, i), pixel_mm));
}

UnitScan::WindowOnPixels UnitScan::windowOnPixels(const EntityPlan& plan, const Station& station,
                                                  const TileView* view) const {
  if (view == nullptr) return {};
  const LocalPixelMap map = cameraFor(plan).localMap(X_TS_ * station.p_S_mm - view->tile.p_TV_mm);
  const CaliperWindow window = windowOf(station, plan, options_.reach_mm);
  const Eigen::Matrix2d pixel_per_S =
      map.pixel_per_mm * X_TS_.rotation() * (window.back_mm + window.ahead_mm);
  const Eigen::Vector2d normal(-station.tangent.y(), station.tangent.x());
  return {pixel_per_S * station.tangent, pixel_per_S * normal};
}

void UnitScan::cuts(KerfScan& scan) const {
  const std::vector<EntityPlan>& plans = plan_.entities;
  std::vector<EntityKerf> kerfs(plans.size());
  std::vector<Measured> measured(plans.size());
  base::forEachIndex(plans.size(), options_.threads, [&](std::size_t e) {
    kerfs[e] = {unit_, plans[e].entity, {}};
    kerfs[e].depth_mm = depthOf(plans[e]).mm;
    kerfs[e].depth_sigma_mm = depthOf(plans[e]).sigma_mm;
    measure(plans[e], kerfs[e], measured[e]);
  });
  // Scorch dims creases, and cuts not: how wide cuts are, cuts alone tell.
  const FlankBelief by_cuts = beliefOf(kerfs, measured, false);
  const FlankBelief belief = beliefOf(kerfs, measured, true);
  base::forEachIndex(plans.size(), options_.threads, [&](std::size_t e) {
    correct(plans[e], plans[e].process == dieline::Process::kCut ? by_cuts : belief, kerfs[e], measured[e]);
  });
  std::vector<CutNoise> noise;
  for (std::size_t e = 0; e < plans.size(); ++e) {
    noise.push_back(std::move(measured[e].noise));
    if (measured[e].unseen > 0) {
      scan.problems.push_back("unit " + std::to_string(unit_) + ": " + std::to_string(measured[e].unseen) +
                              " of " + std::to_string(plans[e].stations.size()) + " calipers of E" +
                              std::to_string(plans[e].entity) + " lie outside the tiles");
    }
  }
  setSigmas(plan_, noise, kerfs);
  joints(kerfs, belief, scan);
  patches(kerfs, scan);
  std::move(kerfs.begin(), kerfs.end(), std::back_inserter(scan.entities));
}

Eigen::Vector2d UnitScan::depthSigma_mm(const EntityPlan& plan, const Eigen::Vector2d& p_S_mm) const {
  const Eigen::Vector2d p_T_mm = X_TS_ * p_S_mm;
  const TileView* view = index_.best(p_T_mm, 0.0);
  if (view == nullptr) return Eigen::Vector2d::Zero();
  const SightDepth& depth = depthOf(plan);
  // A telecentric lens is not square by an angle of unknown direction; no tile tells how deep it looks.
  const double unsquare_mm = 0.5 * depth.deepest_mm() * calibration_.square_within_rad;
  const Eigen::Vector2d slope =
      X_TS_.rotation().transpose() * calibration_.sightSlope(p_T_mm - view->tile.p_TV_mm);
  return (depth.sigma_mm * slope).cwiseAbs() + Eigen::Vector2d::Constant(unsquare_mm);
}

Eigen::Vector2d UnitScan::scaleSigma_mm(const Eigen::Vector2d& p_S_mm) const {
  return options_.scale_sigma * (p_S_mm - marks_centre_S_mm_);
}

UnitScan::Hidden UnitScan::hiddenBy(const Eigen::Vector2d& p_V_mm, const Eigen::Vector2d& direction_S) const {
  if (calibration_.telecentric_mm > 0.0) {
    // Any share of the walls, each as likely, times the size of a normal angle: its mean is sqrt(2/pi) sigma.
    const double aslant_mm = options_.board_thickness_mm * 0.5 * calibration_.square_within_rad;
    const double likely = kNarrowing * std::sqrt(2.0 / std::numbers::pi);
    const double square = kNarrowing * kNarrowing + kNarrowingSigma * kNarrowingSigma;
    return {likely * aslant_mm, std::sqrt(square - likely * likely) * aslant_mm};
  }
  const Eigen::Vector2d direction_T = X_TS_.rotation() * direction_S;
  const double aslant_mm =
      options_.board_thickness_mm * std::abs(calibration_.sightSlope(p_V_mm).dot(direction_T));
  return {kNarrowing * aslant_mm, kNarrowingSigma * aslant_mm};
}

void UnitScan::widen(const EntityPlan& plan, EntityKerf& kerf) const {
  if (kerf.calipers.empty()) return;
  double sum_mm = 0.0;
  for (std::size_t i = 0; i < kerf.calipers.size(); ++i) {
    const Eigen::Vector2d& t = plan.stations[i].tangent;
    const Hidden hidden = hiddenBy(kerf.calipers[i].p_V_mm, Eigen::Vector2d(-t.y(), t.x()));
    kerf.calipers[i].width_mm += hidden.likely_mm;
    sum_mm += hidden.sigma_mm;
  }
  kerf.walls_sigma_mm = sum_mm / static_cast<double>(kerf.calipers.size());
  kerf.widening_sigma_mm = std::hypot(kerf.widening_sigma_mm, kerf.walls_sigma_mm);
}

void UnitScan::lengthen(const Eigen::Vector2d& p_S_mm, const Eigen::Vector2d& outward, LineEnd& end) const {
  const Eigen::Vector2d p_T_mm = X_TS_ * p_S_mm;
  const TileView* view = index_.best(p_T_mm, 0.0);
  if (view == nullptr) return;
  // Read in the plane of its middle, a slit loses as much at the one end as at the other.
  const Hidden hidden = hiddenBy(p_T_mm - view->tile.p_TV_mm, outward);
  end.gap_mm -= 0.5 * hidden.likely_mm;
  end.sigma_mm = std::hypot(end.sigma_mm, 0.5 * hidden.sigma_mm);
}

JointScene UnitScan::sceneOf(const EntityPlan& plan, const std::vector<EntityKerf>& kerfs,
                             const FlankBelief& belief) const {
  return {.tiles = &index_,
          .calibration = &cameraFor(plan),
          .X_TS = &X_TS_,
          .options = &options_,
          .plan = &plan_,
          .kerfs = &kerfs,
          .belief = &belief,
          .unit = unit_};
}

void UnitScan::joints(const std::vector<EntityKerf>& kerfs, const FlankBelief& belief, KerfScan& scan) const {
  std::vector<CornerKerf> corners(plan_.corners.size());
  base::forEachIndex(corners.size(), options_.threads, [&](std::size_t i) {
    const PlannedCorner& planned = plan_.corners[i];
    const EntityPlan& entity = plan_.entities[planned.in.plan];
    corners[i] = measureCorner(sceneOf(entity, kerfs, belief), planned);
    const double by_table_mm = std::hypot(options_.table_sigma_mm, scaleSigma_mm(planned.in.p_S_mm).norm());
    corners[i].deviation_sigma_mm = std::hypot(corners[i].deviation_sigma_mm,
                                               depthSigma_mm(entity, planned.in.p_S_mm).norm(), by_table_mm);
  });
  scan.corners.insert(scan.corners.end(), corners.begin(), corners.end());
  const auto areCut = [&](const EntityEnd& end) {  // Perforations may end in a bridge.
    return plan_.entities[end.plan].process != dieline::Process::kPerforation;
  };
  std::vector<EntityEnd> ends;
  std::ranges::copy_if(plan_.free_ends, std::back_inserter(ends), areCut);
  const std::size_t free = ends.size();
  std::ranges::copy_if(plan_.closures, std::back_inserter(ends), areCut);
  std::vector<LineEnd> measured(ends.size());
  base::forEachIndex(ends.size(), options_.threads, [&](std::size_t i) {
    const JointScene scene = sceneOf(plan_.entities[ends[i].plan], kerfs, belief);
    // What start and end of a closed line have in common does not part them.
    measured[i] = i < free ? freeEnd(scene, ends[i]) : measureClosure(scene, ends[i]);
  });
  scan.ends.insert(scan.ends.end(), measured.begin(), measured.end());
}

LineEnd UnitScan::freeEnd(const JointScene& scene, const EntityEnd& end) const {
  LineEnd measured = measureEnd(scene, end);
  lengthen(end.p_S_mm, end.outward, measured);
  const double by_depth_mm = depthSigma_mm(plan_.entities[end.plan], end.p_S_mm).dot(end.outward.cwiseAbs());
  const double by_scale_mm = scaleSigma_mm(end.p_S_mm).dot(end.outward);
  measured.sigma_mm =
      std::hypot(measured.sigma_mm, by_depth_mm, std::hypot(options_.table_sigma_mm, by_scale_mm));
  return measured;
}

void UnitScan::strays(KerfScan& scan) const {
  std::vector<std::vector<StrayBox>> per_tile(tiles_.size());
  base::forEachIndex(tiles_.size(), options_.threads, [&](std::size_t t) {
    per_tile[t] = findStrays(tiles_[t], t, seen_.front(), X_TS_, plan_.entities, options_.open_gray);
  });
  std::vector<StrayBox> boxes;
  for (const auto& some : per_tile) boxes.insert(boxes.end(), some.begin(), some.end());
  const std::vector<StrayCut> strays = mergeStrays(std::move(boxes), unit_, options_.stray_min_mm);
  scan.strays.insert(scan.strays.end(), strays.begin(), strays.end());
}

void UnitScan::patches(const std::vector<EntityKerf>& kerfs, KerfScan& scan) const {
  std::vector<Worst> worst;
  for (std::size_t e = 0; e < plan_.entities.size(); ++e) {
    Worst here;
    for (std::size_t i = 0; i < kerfs[e].calipers.size(); ++i) {
      const Caliper& caliper = kerfs[e].calipers[i];
      if (!caliper.found || caliper.near_joint || std::abs(caliper.offset_mm) <= here.offset_mm) continue;
      here = {std::abs(caliper.offset_mm), &plan_.entities[e], &plan_.entities[e].stations[i]};
    }
    if (here.station != nullptr) worst.push_back(here);
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [](const Worst& a, const Worst& b) { return a.offset_mm > b.offset_mm; });
  worst.resize(std::min(worst.size(), static_cast<std::size_t>(std::max(0, options_.patches))));
  for (const Worst& w : worst) {
    if (auto patch = cropPatch(w, unit_, index_, calibration_, X_TS_)) {
      scan.patches.push_back(std::move(*patch));
    }
  }
}

}  // namespace kerfbench::vision
