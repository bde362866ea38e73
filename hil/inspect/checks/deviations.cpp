// SPDX-License-Identifier: Apache-2.0
// Where the cut lies: deviation of lines, corners and ends, and width, with what they are worth.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/deviation/worst_deviation.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "hil/vision/kerf/kerf_profile.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr std::uint64_t kPathSeed = 0x706174685f6d6d31ULL;

LineKind kindOf(const Evidence& evidence, const ReadingLine& line) {
  const vision::EntityKerf& kerf = evidence.kerf.entities[line.kerf];
  const dieline::Entity& entity = entityOf(evidence, kerf.entity);
  LineKind kind;
  kind.layer = entity.layer;
  const auto* arc = std::get_if<dieline::ArcCurve>(&entity.curve);
  if (arc == nullptr || !dieline::isClosed(entity.curve)) return kind;
  kind.is_circle = true;
  kind.window_rad = 2.0 * std::min(vision::kWindowHalfMm / arc->radius_mm, vision::kLongestArcRad);
  for (const std::size_t i : line.caliper) {
    const Eigen::Vector2d from = kerf.calipers[i].p_S_mm - arc->centre_mm;
    kind.angle_rad.push_back(std::atan2(from.y(), from.x()));
  }
  return kind;
}

/// Readings this far from the median, in units of their scatter, are not the kerf's width.
constexpr double kOutlier = 5.0;
// A width is the difference of two flanks, an offset their mean: twice as much if they erred each for itself;
// what artefacts of known width show (`kerfbench gauge`).
constexpr double kFlanks = 1.4;
// Share of what blur adds to a width: how well one kerf's shape tells it. How well the blur itself is known
// is EntityKerf::widening_sigma_mm.
constexpr double kOwnBlurShare = 0.032;
// The same of one that lets only part of the light through, whose middle must tell how deep it is.
constexpr double kShallowBlurShare = 0.06;
constexpr double kShallow = 0.85;  // Brightness.

struct KerfWidth {
  Quantity width;
  double own_U{std::numeric_limits<double>::quiet_NaN()};  ///< Without what all widths have in common.
};

/// Mean width without outliers, and its U. (A median would need to know how the true width is spread.) Noise
/// of neighbours is taken to be as correlated as that of their offsets.
KerfWidth widthOf(const vision::EntityKerf& kerf, const ReadingLine& line) {
  std::vector<double> widths;
  std::vector<double> off;
  for (const std::size_t i : line.caliper) {
    if (std::isfinite(kerf.calipers[i].width_mm)) widths.push_back(kerf.calipers[i].width_mm);
  }
  if (widths.empty()) return {};
  const double median = medianOf(widths);
  for (const double w : widths) off.push_back(std::abs(w - median));
  const double scatter = kMadToSigma * medianOf(off);
  double sum = 0.0;
  double n = 0.0;
  double variance = 0.0;
  double behind = 0.0;
  double steady = 0.0;
  double brightness = 0.0;
  std::size_t last = 0;
  for (const std::size_t i : line.caliper) {
    const vision::Caliper& c = kerf.calipers[i];
    if (!(std::abs(c.width_mm - median) <= kOutlier * std::max(scatter, c.width_sigma_mm))) continue;
    behind *= n > 0.0 ? std::pow(line.q, static_cast<double>(i - last)) : 0.0;
    const double steady_mm = std::min(kFlanks * c.steady_sigma_mm, c.width_sigma_mm);
    const double noise_mm = std::sqrt(c.width_sigma_mm * c.width_sigma_mm - steady_mm * steady_mm);
    variance += noise_mm * (noise_mm + 2.0 * behind);
    behind += noise_mm;
    steady += steady_mm;
    last = i;
    sum += c.width_mm;
    brightness += c.brightness;
    n += 1.0;
  }
  const double share = brightness < kShallow * n ? kShallowBlurShare : kOwnBlurShare;
  const double u_own_mm = std::hypot(std::hypot(std::sqrt(variance), steady) / n, share * kerf.widening_mm);
  return {{sum / n, 2.0 * std::hypot(u_own_mm, kerf.widening_sigma_mm)}, 2.0 * u_own_mm};
}

/// Widths of a process are compared with the usual one: walls that are seen more or less aslant than those of
/// the usual one hide more or less of a kerf, by as much as is not known of any.
void addWalls(const Evidence& evidence, std::vector<double>& width_own_U) {
  const std::vector<vision::EntityKerf>& kerfs = evidence.kerf.entities;
  std::map<dieline::Process, std::vector<double>> walls;
  for (const vision::EntityKerf& kerf : kerfs)
    walls[entityOf(evidence, kerf.entity).process].push_back(kerf.walls_sigma_mm);
  std::map<dieline::Process, double> usual;
  for (const auto& [process, values] : walls) usual[process] = medianOf(values);
  for (std::size_t l = 0; l < kerfs.size(); ++l) {
    const double usual_mm = usual[entityOf(evidence, kerfs[l].entity).process];
    width_own_U[l] = std::hypot(width_own_U[l], 2.0 * (kerfs[l].walls_sigma_mm - usual_mm));
  }
}

/// Standard uncertainty of a place on the sheet, per axis, by the pose of its unit and the camera's map.
double placeSigma(const Evidence& evidence, int unit, const Eigen::Vector2d& p_S_mm) {
  const auto& units = evidence.kerf.units;
  const auto pose =
      std::find_if(units.begin(), units.end(), [&](const vision::UnitPose& p) { return p.unit == unit; });
  if (pose == units.end() || !evidence.kerf_calibration) return kNan;
  const Eigen::Vector2d arm = Eigen::Rotation2Dd(pose->angle_rad) * p_S_mm;
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
  return std::hypot(std::sqrt(0.5 * (J * pose->covariance * J.transpose()).trace()),
                    evidence.kerf_calibration->map_u_mm);
}

}  // namespace

const dieline::Entity& entityOf(const Evidence& evidence, int id) {
  return evidence.dieline->entities[static_cast<std::size_t>(id)];
}

DeviationResult measureLines(const Evidence& evidence, const Tolerances& limits, const EdgeSides* edges) {
  ErrorModel model = errorModelOf(evidence);
  if (edges != nullptr) addWidthErrors(evidence.kerf, *edges, model);
  std::vector<LineKind> kinds;
  for (std::size_t l = 0; l < model.size(); ++l)
    kinds.push_back(kindOf(evidence, model.line(l, ErrorModel::Part::kReadings)));
  DeviationResult result = measureDeviations(model, kinds, limits.path_mm, kPathSeed, evidence.threads);
  if (edges != nullptr) addBlurUncertainty(evidence.kerf, *edges, limits.path_mm, result);
  const auto placeOf = [&](DeviationEstimate& e) {
    if (e.line >= model.size()) return;
    const ReadingLine line = model.line(e.line, ErrorModel::Part::kReadings);
    if (e.reading < line.size()) e.caliper = line.caliper[e.reading];
  };
  for (std::size_t l = 0; l < model.size(); ++l) {
    const ReadingLine line = model.line(l, ErrorModel::Part::kReadings);
    const KerfWidth width = widthOf(evidence.kerf.entities[l], line);
    result.widths.push_back(width.width);
    result.width_own_U.push_back(width.own_U);
    placeOf(result.lines[l]);
  }
  addWalls(evidence, result.width_own_U);
  for (DeviationEstimate& e : result.layers) placeOf(e);
  placeOf(result.all);
  return result;
}

std::vector<EntityResult> measureEntities(const Evidence& evidence, const Tolerances& limits,
                                          const DeviationResult& deviations) {
  std::vector<EntityResult> results;
  for (std::size_t k = 0; k < evidence.kerf.entities.size(); ++k) {
    const vision::EntityKerf& kerf = evidence.kerf.entities[k];
    const DeviationEstimate& d = deviations.lines[k];
    EntityResult e;
    e.unit = kerf.unit;
    e.entity = kerf.entity;
    e.worst_mm = e.worst_u = kNan;
    if (std::isfinite(d.worst_as_read)) {
      const vision::Caliper& c = kerf.calipers[d.caliper];
      e.worst_mm = std::copysign(d.worst.value, c.offset_mm);
      e.worst_u = c.u;
    }
    e.worst_U_mm = d.worst.U;
    e.rms_mm = d.rms.value;
    e.rms_U_mm = d.rms.U;
    e.coverage = coverageOf(evidence, kerf, limits);
    e.uncut_mm = longestUncut(evidence, kerf, limits).length_mm;
    e.width_mm = deviations.widths[k].value;
    e.width_U_mm = deviations.widths[k].U;
    e.width_own_U_mm = deviations.width_own_U[k];
    // What is no wider than nothing is no kerf: its calipers were set on light of others.
    if (!(e.width_mm > 0.0)) e.width_mm = e.width_U_mm = e.width_own_U_mm = kNan;
    e.circularity_mm = deviations.circularity[k].value;
    e.circularity_U_mm = deviations.circularity[k].U;
    e.passes = kNan;
    results.push_back(e);
  }
  return results;
}

std::vector<JointResult> measureJoints(const Evidence& evidence) {
  std::vector<JointResult> joints;
  const auto quantity = [&](bool found, double value_mm, double sigma_mm, double place_mm) {
    return found ? Quantity{value_mm, 2.0 * std::hypot(sigma_mm, place_mm)} : Quantity{};
  };
  for (const vision::CornerKerf& c : evidence.kerf.corners) {
    const double place_mm = placeSigma(evidence, c.unit, c.p_S_mm);
    JointResult j{JointResult::Kind::kCorner, c.unit, c.entity_in, c.entity_out, c.p_S_mm, false, {}};
    j.short_leg = c.short_leg;
    j.mm = quantity(c.found, c.deviation_mm, c.deviation_sigma_mm, place_mm);
    joints.push_back(j);
    // Against its own legs, which move with the sheet.
    j.kind = JointResult::Kind::kRounding;
    j.mm = quantity(c.found, c.rounding_mm, c.rounding_sigma_mm, 0.0);
    joints.push_back(j);
    j.kind = JointResult::Kind::kOvershoot;
    j.mm = quantity(c.found, c.overshoot_mm, c.overshoot_sigma_mm, 0.0);
    joints.push_back(j);
  }
  for (const vision::LineEnd& end : evidence.kerf.ends) {
    if (end.entity < 0 || end.entity >= static_cast<int>(evidence.dieline->entities.size())) continue;
    const dieline::Curve& curve = entityOf(evidence, end.entity).curve;
    const Eigen::Vector2d p_S_mm = dieline::pointAt(curve, end.at_start ? 0.0 : 1.0);
    const bool closes = dieline::isClosed(curve);
    JointResult j{closes ? JointResult::Kind::kClosure : JointResult::Kind::kEndGap,
                  end.unit,
                  end.entity,
                  end.entity,
                  p_S_mm,
                  end.at_start,
                  {}};
    // Both sides of a closure move with the sheet.
    j.mm =
        quantity(end.found, end.gap_mm, end.sigma_mm, closes ? 0.0 : placeSigma(evidence, end.unit, p_S_mm));
    joints.push_back(j);
  }
  return joints;
}

Check pathCheck(const Evidence& evidence, const Tolerances& limits, const DeviationResult& deviations) {
  Check check{.name = "path", .title = "Deviation of the cut from the dieline", .unit = "mm"};
  check.limit = limits.path_mm;
  const DeviationEstimate& all = deviations.all;
  check.value = evidence.kerf_calibration ? all.worst.value : kNan;
  check.u = check.guard = all.worst.U;
  check.chance_beyond = deviations.chance_beyond;
  decide(check);
  std::size_t readings = 0;
  std::size_t silent = 0;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    const auto own = std::count_if(kerf.calipers.begin(), kerf.calipers.end(), judgesOffset);
    readings += static_cast<std::size_t>(own);
    if (own == 0) ++silent;
  }
  if (readings == 0) {
    check.explanation =
        "No kerf was found on any dieline entity away from joints, so no deviation could be measured.";
    return check;
  }
  const vision::EntityKerf& kerf = evidence.kerf.entities[all.line];
  const vision::Caliper& worst = kerf.calipers[all.caliper];
  check.subject = nameOf(kerf.unit, kerf.entity);
  check.where = atPlace(kerf.unit, kerf.entity, worst.p_S_mm);
  check.explanation = fmt::format(
      "Of {} readings, smoothed along their lines, the farthest off is {:.4f} mm to the {} of the line at "
      "{}, "
      "station {:.2f} mm; the value allows for picking the largest of so many.",
      readings, all.worst_as_read, sideOf(worst.offset_mm), placeOf(worst.p_S_mm), worst.station_mm);
  if (silent > 0) {
    // Where they lie is not known: farther off, or nowhere.
    check.at_least = check.verdict == Verdict::kFail;
    check.explanation += fmt::format(" {} entities gave no reading; see coverage.", silent);
  }
  return check;
}

}  // namespace kerfbench::inspect::checks
