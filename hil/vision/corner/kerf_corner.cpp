// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/kerf_corner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include "hil/vision/corner/corner_fit.h"
#include "hil/vision/corner/corner_legs.h"
#include "hil/vision/kerf/kerf_leg.h"
#include "hil/vision/kerf/light_law.h"
#include "twin/base/constants.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr double kBesideMm = 0.36;   // Half width of the strip along each leg that is looked at.
constexpr double kOnLegMm = 0.05;    // Distance from a leg up to which a point belongs to it.
constexpr double kMostOffMm = 0.35;  // Largest offset of a kerf that the pixels still hold.
constexpr double kFarthestMm = 1.0;  // Farther from the corner no pixel shows where its legs meet.
constexpr int kDraws = 64;
constexpr double kLeastSigma =
    0.005;  // Least uncertainty of law, begin and radius: a prior must not be exact.
constexpr double kHardSigma = 0.02;
constexpr std::uint64_t kDrawSeed = 0x636f726e6572ULL;
// Error of the model of the picture for a corner that hardly turns, measured in worlds that are not the
// model's
// (./bench gauge --mismatch): lens, light and walls are not known better. It grows as the legs' kerfs run
// into each other over more of their length.
constexpr double kArcModelMm = 0.0021;
constexpr double kLegsModelMm = 0.001;
constexpr double kRoundingModelMm = 0.0018;
constexpr double kOverModelMm = 0.0032;
constexpr double kSharpest = 0.2;  // Cosine of half the turn of the sharpest corner that is told apart.
/// Uncertainty over the flicker of the legs' half widths, as the arc has fewer places.
constexpr double kFlickerShare = 1.7;
// Uncertainty of the end of a leg that overruns: none where it hardly stands out, largest at about 10 um,
// which the flank of the other leg half hides, and smaller farther out, where the lens matters less: there
// the leg ends as free ends do.
constexpr double kEndsNearShare = 1.0 / 3.0;  // Uncertainty over the overrun, for a short one.
constexpr double kEndsFarMm2 = 3.8e-5;        // Uncertainty times the overrun, for a long one.
constexpr double kEndsLightMm = 0.0035;       // What radius and light leave of it, however far out.
/// Share of the distance by which a bent leg leaves its tangent unseen.
constexpr double kBentDeviation = 0.25;
constexpr double kBentMeeting = 1.3;

/// Points of other curves near the corner, relative to it.
std::vector<Vector2d> othersNear(const JointScene& scene, const PlannedCorner& corner,
                                 const CornerShape& nominal) {
  std::vector<Vector2d> others;
  const auto onLeg = [&](const CornerLeg& leg, const Vector2d& p_mm) {
    const CornerLeg::Place place = leg.placeOf(p_mm);
    return place.along_mm > -kOnLegMm && std::abs(place.beside_mm) < kOnLegMm;
  };
  for (const EntityEnd* end : {&corner.in, &corner.out}) {
    for (const Vector2d& p_S_mm : scene.plan->entities[end->plan].hidden_S_mm) {
      const Vector2d p_mm = p_S_mm - corner.in.p_S_mm;
      if (p_mm.norm() > kCornerLegMm + kBesideMm + kHiddenMm) continue;
      if (!onLeg(nominal.in, p_mm) && !onLeg(nominal.out, p_mm)) others.push_back(p_mm);
    }
  }
  return others;
}

/// The pixels around the corner and which of them count.
CornerPicture pictureOf(const JointScene& scene, const PlannedCorner& corner, const TileView& view,
                        const CornerShape& nominal) {
  const PlaneMotion& X_TS = *scene.X_TS;
  const LocalPixelMap map = scene.calibration->localMap(X_TS * corner.in.p_S_mm - view.tile.p_TV_mm);
  const Eigen::Matrix2d mm_per_pixel = (map.pixel_per_mm * X_TS.rotation()).inverse();
  const double in_mm = lookedAtMm(scene, corner.in);
  const double out_mm = lookedAtMm(scene, corner.out);
  Eigen::AlignedBox2d box(Vector2d::Zero());
  const auto hold = [&](const CornerLeg& leg, double length_mm) {
    for (const double along_mm : {0.0, 0.5 * length_mm, length_mm}) {
      for (const double side : {-kBesideMm, kBesideMm}) {
        CornerLeg shifted = leg;
        shifted.offset_mm = side;
        box.extend(map.pixel_per_mm * X_TS.rotation() * shifted.at(along_mm));
      }
    }
    box.extend(map.pixel_per_mm * X_TS.rotation() * (-kBesideMm * leg.outwards));
  };
  hold(nominal.in, in_mm);
  hold(nominal.out, out_mm);
  const GrayImage& image = view.tile.image;
  const int left = std::max(0, static_cast<int>(std::floor(map.pixel.x() + box.min().x())));
  const int top = std::max(0, static_cast<int>(std::floor(map.pixel.y() + box.min().y())));
  const int right = std::min(image.width - 1, static_cast<int>(std::ceil(map.pixel.x() + box.max().x())));
  const int bottom = std::min(image.height - 1, static_cast<int>(std::ceil(map.pixel.y() + box.max().y())));
  CornerPicture picture;
  picture.grid = {std::max(0, right - left + 1), std::max(0, bottom - top + 1),
                  mm_per_pixel * (Vector2d(left, top) - map.pixel), mm_per_pixel.col(0), mm_per_pixel.col(1)};
  const double light = view.light.at(map.pixel);
  picture.noise_gray = view.noise_gray / light;
  const std::vector<Vector2d> others = othersNear(scene, corner, nominal);
  const auto within = [](const CornerLeg& leg, double length_mm, const Vector2d& p_mm) {
    const CornerLeg::Place place = leg.placeOf(p_mm);
    return place.along_mm >= 0.0 && place.along_mm <= length_mm && std::abs(place.beside_mm) <= kBesideMm;
  };
  for (int r = 0; r < picture.grid.rows; ++r) {
    for (int c = 0; c < picture.grid.columns; ++c) {
      const Vector2d p_mm = picture.grid.at(c, r);
      const bool hidden = std::any_of(others.begin(), others.end(), [&](const Vector2d& other) {
        return (other - p_mm).squaredNorm() < kHiddenMm * kHiddenMm;
      });
      picture.gray.push_back(static_cast<float>(image.gray(left + c, top + r) / light));
      picture.counts.push_back(!hidden && (within(nominal.in, in_mm, p_mm) ||
                                           within(nominal.out, out_mm, p_mm) || p_mm.norm() <= kBesideMm));
    }
  }
  return picture;
}

/// Whether the drawing leaves fewer calipers on a leg than its line is told from.
bool isShort(const JointScene& scene, const EntityEnd& end) {
  const EntityPlan& plan = scene.plan->entities[end.plan];
  const double from_mm = scene.stationOf(end);
  const auto tells = [&](const Station& s) {
    return !s.near_corner && std::abs(s.station_mm - from_mm) >= kLegFromMm;
  };
  return std::ranges::count_if(plan.stations, tells) < kFewestOnLeg;
}

/// Share of the cutting fluence in the middle of a leg, by how wide it is.
double peakOf(const CornerLight& light, const KerfLeg& leg) {
  const double transmission = light.board_gray / light.open_gray;
  const double half = transmission + 0.5 * leg.brightness * (1.0 - transmission);
  const double a = leg.half_width_mm / light.beam_radius_mm;
  const double share = LightLaw(transmission, light.growth).shareAt(std::min(half, 1.0));
  return std::clamp(share * std::exp(2.0 * a * a), 0.2, 20.0);
}

/// Light, beam and blur as the flanks of all kerfs show them. A hard tool is as wide as the kerf.
void setLight(const FlankBelief& belief, double kerf_width_mm, CornerKnown& known) {
  CornerLight& light = known.light;
  const FlankMoments law = belief.momentsOf([](const FlankView& view) { return view.growth.law; });
  const FlankMoments begin = belief.momentsOf([](const FlankView& view) { return view.growth.begin; });
  const FlankMoments blur = belief.momentsOf([](const FlankView& view) { return view.lens_px; });
  const FlankMoments radius = belief.momentsOf([](const FlankView& view) { return view.beam_radius_mm; });
  const bool hard = !(radius.likely > 0.0);
  light.growth = {law.likely, begin.likely};
  light.blur_px = blur.likely;
  light.beam_radius_mm = hard ? kerf_width_mm : radius.likely;
  known.law_sigma = std::max(law.sigma, kLeastSigma);
  known.begin_sigma = std::max(begin.sigma, kLeastSigma);
  known.blur_sigma_px = blur.sigma;
  known.radius_share_sigma = hard ? kHardSigma : std::max(radius.sigma / radius.likely, kLeastSigma);
}

/// What the fit's covariance makes of a quantity: mean and standard deviation of its change.
struct Spread {
  double sum{}, squares{};
  void add(double change) {
    sum += change;
    squares += change * change;
  }
  [[nodiscard]] double mean() const { return sum / kDraws; }
  [[nodiscard]] double sigma(double model) const {
    return std::hypot(std::sqrt(std::max(0.0, squares / kDraws - mean() * mean())), model);
  }
};

/// How far a bent leg leaves its tangent over the length where an arc takes its place, or where it runs over:
/// no pixel shows it there.
double bendWithin(const CornerLeg& leg, double length_mm) {
  return length_mm * length_mm *
         (std::abs(leg.curvature_per_mm) / 2.0 + std::abs(leg.twist_per_mm2) * length_mm / 6.0);
}

double endModelMm(double over_mm) {
  if (!(over_mm > 0.0)) return 0.0;
  return std::min(kEndsNearShare * over_mm, std::hypot(kEndsFarMm2 / over_mm, kEndsLightMm));
}

double turnOf(const CornerShape& shape) {
  return std::acos(std::clamp(-shape.in.outwards.dot(shape.out.outwards), -1.0, 1.0));
}

/// Growth of the model's error with the turn.
double sharpnessOf(const CornerShape& shape) {
  return 1.0 / std::max(kSharpest, std::cos(0.5 * turnOf(shape)));
}

/// What the model leaves of a deviation: ends count as far as the deviation is theirs.
double deviationModelMm(const CornerShape& shape, double reach_mm) {
  if (shape.rounding_mm > 0.0) return sharpnessOf(shape) * kArcModelMm;
  CornerShape longer = shape, shorter = shape;
  for (CornerLeg CornerShape::*leg : {&CornerShape::in, &CornerShape::out}) {
    const double model_mm = endModelMm((shape.*leg).over_mm);
    (longer.*leg).over_mm += model_mm;
    (shorter.*leg).over_mm -= model_mm;
  }
  const double of_ends_mm = 0.5 * (deviationMm(longer, reach_mm) - deviationMm(shorter, reach_mm));
  return std::hypot(sharpnessOf(shape) * kLegsModelMm, of_ends_mm);
}

/// Deviation of the corner and meeting of its legs, with their uncertainties.
void evaluate(const CornerFit& fit, double reach_mm, double flicker_mm, CornerKerf& out) {
  const auto overOf = [](const CornerShape& s) { return std::max({0.0, s.in.over_mm, s.out.over_mm}); };
  const double deviation_mm = deviationMm(fit.shape, reach_mm);
  const double over_mm = overOf(fit.shape);
  const Eigen::LLT<Eigen::MatrixXd> root(fit.covariance);
  const CounterRandom random(kDrawSeed, 0);
  Spread deviation, over, rounding;
  const auto n = static_cast<int>(fit.covariance.rows());
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd e(n);
    for (int k = 0; k < n; ++k) e[k] = random.normal(static_cast<std::uint64_t>((draw / 2) * n + k));
    if (draw % 2 == 1) e = -e;
    const CornerShape shape = fit.shapeAt(root.matrixL() * e);
    deviation.add(deviationMm(shape, reach_mm) - deviation_mm);
    over.add(overOf(shape) - over_mm);
    rounding.add(shape.rounding_mm - fit.shape.rounding_mm);
  }
  const bool arc = fit.shape.rounding_mm > 0.0;
  const double turn_rad = turnOf(fit.shape);
  const double sharp = sharpnessOf(fit.shape);
  const double hidden_mm = arc ? arcLegMm(turn_rad, fit.shape.rounding_mm) : over_mm;
  const double bent_mm = std::max(bendWithin(fit.shape.in, hidden_mm), bendWithin(fit.shape.out, hidden_mm));
  const double unsteady_mm = kFlickerShare * flicker_mm;
  const double meeting_mm = std::hypot(unsteady_mm, kBentMeeting * bent_mm);
  // The farthest of many places that are each uncertain lies too far.
  out.deviation_mm = std::max(0.0, deviation_mm - deviation.mean());
  // U, twice this, takes in the other way that the legs may meet.
  const double other_mm = fit.other ? 0.5 * std::abs(deviationMm(*fit.other, reach_mm) - deviation_mm) : 0.0;
  const double model_mm =
      std::hypot(deviationModelMm(fit.shape, reach_mm), unsteady_mm, kBentDeviation * bent_mm);
  out.deviation_sigma_mm = deviation.sigma(std::hypot(model_mm, other_mm));
  out.rounding_mm = std::max(0.0, fit.shape.rounding_mm);
  out.rounding_sigma_mm =
      rounding.sigma(std::hypot(sharp * kArcModelMm, sharp * kRoundingModelMm, meeting_mm));
  out.overshoot_mm = arc ? 0.0 : std::max(0.0, over_mm - over.mean());
  out.overshoot_sigma_mm = over.sigma(std::hypot(sharp * kOverModelMm, endModelMm(over_mm), meeting_mm));
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
                 .rounding_sigma_mm = kNan,
                 .overshoot_sigma_mm = kNan,
                 .deviation_sigma_mm = kNan};
  out.short_leg = isShort(scene, corner.in) || isShort(scene, corner.out);
  if (out.short_leg) return out;
  const TileView* view = scene.tileFor(out.p_S_mm, kCornerLegMm + kBesideMm);
  const auto in = legAt((*scene.kerfs)[corner.in.plan], scene.stationOf(corner.in), kLegFromMm);
  const auto on = legAt((*scene.kerfs)[corner.out.plan], scene.stationOf(corner.out), kLegFromMm);
  if (view == nullptr || !in || !on) return out;
  const LegGuess leg_in = followCalipers(scene, corner.in, *in);
  const LegGuess leg_out = followCalipers(scene, corner.out, *on);
  CornerKnown known;
  known.legs = {{.in = leg_in.near, .out = leg_out.near}, {.in = leg_in.far, .out = leg_out.far}};
  known.in = leg_in.known;
  known.out = leg_out.known;
  const CornerPicture picture = pictureOf(
      scene, corner, *view, {.in = nominalLeg(scene, corner.in), .out = nominalLeg(scene, corner.out)});
  const KerfScanOptions& options = *scene.options;
  CornerLight& light = known.light;
  light.board_gray = std::clamp(scene.boardAt(*view, out.p_S_mm), 1.0, 0.9 * options.open_gray);
  light.open_gray = options.open_gray;
  setLight(*scene.belief, in->half_width_mm + on->half_width_mm, known);
  light.peak_in = peakOf(light, *in);
  light.peak_out = peakOf(light, *on);
  const auto fit = fitCorner(picture, known);
  if (!fit) return out;
  const double off_mm = std::max(std::abs(fit->shape.in.offset_mm), std::abs(fit->shape.out.offset_mm));
  if (off_mm > kMostOffMm) return out;
  // Legs that sway may lie side by side where they should meet.
  if (deviationMm(fit->shape, scene.options->joint_clearance_mm) > kFarthestMm) return out;
  out.found = true;
  evaluate(*fit, scene.options->joint_clearance_mm, std::max(in->flicker_mm, on->flicker_mm), out);
  return out;
}

}  // namespace kerfbench::vision
