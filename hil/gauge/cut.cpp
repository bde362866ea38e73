// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/LU>

#include "hil/dieline/geometry.h"
#include "twin/base/constants.h"
#include "twin/laser/power_noise.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;

constexpr double kStep_mm =
    0.03;  // Step of the burn: chords shift the cut of the smallest circle by 0.03 µm.
constexpr double kSpeed_mm_s = 300.0;
constexpr double kJump_s = 0.02;        // Between entities.
constexpr double kCutShare = 1.6;       // Multiple of the fluence that just cuts through.
constexpr double kCreaseDepth = 0.8;    // Share of the thickness.
constexpr double kNearCorner_mm = 0.4;  // KerfScanOptions::joint_clearance_mm
constexpr double kNearCornerEnd_mm = kNearCorner_mm - 1e-6;  // A station may lie there, but for rounding.
constexpr double kLeg_mm = 0.6;      // Leg of a corner, in which its path is looked for,
constexpr double kFine_mm = 0.001;   // at such steps.
constexpr int kLightParts = 24;      // Parts of the beam's light along the path, to each side.
constexpr double kLightReach = 4.0;  // Standard deviations.

Vector2d leftOf(const Vector2d& v) { return {-v.y(), v.x()}; }

/// From a ray that starts in the origin.
double distanceToRay(const Vector2d& p, const Vector2d& direction) {
  return p.dot(direction) < 0.0 ? p.norm() : std::abs(leftOf(direction).dot(p));
}

/// Fluence that the nominal beam leaves in the middle of a line, over that which cuts through.
double shareOf(dieline::Process process, const twin::BoardDescription& board, const ArtefactBeam& beam) {
  if (process != dieline::Process::kCrease) return kCutShare;
  return beam.crease_energy * twin::DepthCurve(board).fluenceFor_j_mm2(kCreaseDepth) /
         board.cut_fluence_j_mm2;
}

/// How many whole waves go onto a line, so that a closed one still closes.
double wavesOn(double length_mm, double wave_mm) { return std::max(1.0, std::round(length_mm / wave_mm)); }

}  // namespace

ArtefactCut::ArtefactCut(const Artefact& artefact, std::vector<Fault> faults, const ArtefactBeam& beam,
                         std::uint64_t noise_seed)
    : artefact_(artefact), faults_(std::move(faults)), beam_(beam) {
  middle_mm_ = artefact.dieline.bounds().center();
  twin::PowerNoise noise(beam.noise, beam.noise_correlation_s, noise_seed);
  double time_s = 0.0;
  for (const dieline::Entity& entity : artefact.dieline.entities) {
    Line line;
    line.entity = &entity;
    line.length_mm = dieline::lengthOf(entity.curve);
    for (const double u : dieline::stations(entity.curve, 0.5))
      reach_mm_ = std::max(reach_mm_, (dieline::pointAt(entity.curve, u) - middle_mm_).norm());
    for (const Fault& fault : faults_) {
      if (fault.kind == FaultKind::kEnd && fault.entity == entity.id)
        (fault.at_start ? line.start_gap_mm : line.end_gap_mm) += fault.size_mm;
    }
    // A little beyond both ends, for lines that are cut too long. The corner is cut without a break.
    if (entity.id == artefact.corner_out) {
      const Line& before = lines_[static_cast<std::size_t>(artefact.corner_in)];
      time_s = before.start_s + (before.length_mm - 1.0) / kSpeed_mm_s;
    }
    line.start_s = time_s + 1.0 / kSpeed_mm_s;
    const auto steps = static_cast<std::size_t>(std::ceil((line.length_mm + 2.0) / kStep_mm));
    const double step_s = kStep_mm / kSpeed_mm_s;
    for (std::size_t i = 0; i < steps; ++i) {
      const double begin_s = time_s + static_cast<double>(i) * step_s;
      // The tube has long warmed up: all of the drift is there.
      line.power.push_back(beam.power * (1.0 + beam.drift) *
                           (1.0 + (noise.silent() ? 0.0 : noise.meanOver(begin_s, begin_s + step_s))));
    }
    time_s += static_cast<double>(steps) * step_s + kJump_s;
    lines_.push_back(std::move(line));
  }
  for (const Fault& fault : faults_) {
    if (fault.kind == FaultKind::kCorner) corner_mm_ += fault.size_mm;
  }
}

double ArtefactCut::relativePower(const Line& line, double s_mm) const {
  const auto last = static_cast<double>(line.power.size() - 1);
  return line.power[static_cast<std::size_t>(std::clamp((s_mm + 1.0) / kStep_mm, 0.0, last))];
}

Vector2d ArtefactCut::shiftAt(const Line& line, double s_mm) const {
  const dieline::Curve& curve = line.entity->curve;
  const double u = s_mm / line.length_mm;
  const Vector2d normal = leftOf(dieline::tangentAt(curve, u));
  const Vector2d from_middle = dieline::pointAt(curve, u) - middle_mm_;
  Vector2d shift = beam_.flutterShift_mm(line.start_s + s_mm / kSpeed_mm_s);
  for (const Fault& f : faults_) {
    const bool own = f.entity == line.entity->id;
    const Vector2d direction(std::cos(f.direction_rad), std::sin(f.direction_rad));
    switch (f.kind) {
      case FaultKind::kOffset:
        shift += f.size_mm * direction;
        break;
      case FaultKind::kBump:
        if (own) {
          const double z = (s_mm - f.place * line.length_mm) / f.length_mm;
          shift += f.size_mm * std::exp(-0.5 * z * z) * normal;
        }
        break;
      case FaultKind::kScale:
        shift += f.size_mm / reach_mm_ * from_middle;
        break;
      case FaultKind::kRotation:
        shift += f.size_mm / reach_mm_ * leftOf(from_middle);
        break;
      case FaultKind::kWave:
        if (line.entity->id == artefact_.corner_in || line.entity->id == artefact_.corner_out) {
          // One swing goes on through the corner, or the beam would have to jump there.
          const double past_mm = line.entity->id == artefact_.corner_in ? s_mm - line.length_mm : s_mm;
          shift += f.size_mm * std::sin(kTurn_rad * past_mm / f.length_mm + f.phase_rad) * direction;
        } else {
          shift += f.size_mm * std::sin(kTurn_rad * u * wavesOn(line.length_mm, f.length_mm) + f.phase_rad) *
                   normal;
        }
        break;
      case FaultKind::kEntity:
        if (own)
          shift += f.size_mm * (std::holds_alternative<dieline::LineCurve>(curve) ? normal : direction);
        break;
      case FaultKind::kCorner:
      case FaultKind::kEnd:
        break;
    }
  }
  return shift;
}

Vector2d ArtefactCut::pathAt(const Line& line, double s_mm) const {
  return dieline::pointAt(line.entity->curve, s_mm / line.length_mm) + shiftAt(line, s_mm);
}

double ArtefactCut::offsetAt(const Line& line, double s_mm) const {
  const dieline::Curve& curve = line.entity->curve;
  const double u = s_mm / line.length_mm;
  const Vector2d p = dieline::pointAt(curve, u);
  const Vector2d tangent = dieline::tangentAt(curve, u);
  const Vector2d normal = leftOf(tangent);
  // Where the path crosses the station's normal, by Newton's method: the slope along it is next to one.
  double at_mm = s_mm;
  for (int i = 0; i < 6; ++i) {
    const double slope = tangent.dot(dieline::tangentAt(curve, at_mm / line.length_mm));
    at_mm -= (pathAt(line, at_mm) - p).dot(tangent) / slope;
  }
  // The arc that a corner is cut by may begin where lines are judged.
  const auto cutAt = [&](double way_mm) -> Vector2d { return pathAt(line, way_mm) + arcShift(line, way_mm); };
  // The kerf's middle is that of the light which falls there, from before and behind: inside of a bend,
  // within the line at its ends, and between begin and end of a closed one.
  const double sigma_mm = std::sqrt(tangent.dot(beam_.covariance_mm2() * tangent));
  const bool closed = dieline::isClosed(curve);
  const double first_mm = line.start_gap_mm;
  const double last_mm = line.length_mm - line.end_gap_mm;
  double weights = 0.0;
  double sum = 0.0;
  for (int i = -kLightParts; i <= kLightParts; ++i) {
    const double z = kLightReach * i / kLightParts;
    double way_mm = at_mm + z * sigma_mm;
    if (closed) {
      way_mm -= line.length_mm * std::floor(way_mm / line.length_mm);
    } else if (way_mm < first_mm || way_mm > last_mm) {
      continue;
    }
    const double weight = std::exp(-0.5 * z * z);
    weights += weight;
    sum += weight * (cutAt(way_mm) - p).dot(normal);
  }
  return weights > 0.0 ? sum / weights : (cutAt(at_mm) - p).dot(normal);
}

double ArtefactCut::widthAt(const Line& line, double s_mm, double fluence_share,
                            const twin::BoardDescription& board) const {
  const Vector2d normal = leftOf(dieline::tangentAt(line.entity->curve, s_mm / line.length_mm));
  const double sigma_mm = std::sqrt(normal.dot(beam_.covariance_mm2() * normal));
  const double peak = fluence_share * relativePower(line, s_mm) * 0.5 / sigma_mm;
  const twin::DepthCurve depth(board);
  const auto lightAt = [&](double share) {
    const double fluence = share * board.cut_fluence_j_mm2;
    const double left = 1.0 - depth.depthAt(fluence);
    const double light = twin::lightThrough(board.light_law, board.transmission, left);
    const double scorch = board.scorch.fluence_j_mm2 > 0.0 && left > 0.0
                              ? board.scorch.darkening * std::min(1.0, fluence / board.scorch.fluence_j_mm2)
                              : 0.0;
    return light * (1.0 - scorch);
  };
  // The fluence at which half of the light comes through that does in the middle, by bisection.
  const double wanted = 0.5 * (lightAt(peak) + board.transmission);
  double half = 0.0;
  double above = std::min(peak, 1.0);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (half + above);
    (lightAt(middle) < wanted ? half : above) = middle;
  }
  return peak > half ? 2.0 * sigma_mm * std::sqrt(2.0 * std::log(peak / half))
                     : std::numeric_limits<double>::quiet_NaN();
}

bool ArtefactCut::judged(const Line& line, double s_mm) const {
  if (s_mm < line.start_gap_mm || s_mm > line.length_mm - line.end_gap_mm) return false;
  if (line.entity->id == artefact_.corner_in && line.length_mm - s_mm < kNearCornerEnd_mm) return false;
  return line.entity->id != artefact_.corner_out || s_mm > kNearCornerEnd_mm;
}

double ArtefactCut::gapOf(const Line& line, bool at_start) const {
  const double s_mm = at_start ? line.start_gap_mm : line.length_mm - line.end_gap_mm;
  const double end_mm = at_start ? 0.0 : line.length_mm;
  const Vector2d tangent = dieline::tangentAt(line.entity->curve, end_mm / line.length_mm);
  const Vector2d outward = at_start ? Vector2d(-tangent) : tangent;
  return (dieline::pointAt(line.entity->curve, end_mm / line.length_mm) - pathAt(line, s_mm)).dot(outward);
}

void ArtefactCut::joints(CutTruth& truth) const {
  for (const Line& line : lines_) {
    if (dieline::isClosed(line.entity->curve)) continue;
    for (const bool at_start : {true, false}) {
      if (at_start ? line.entity->id == artefact_.corner_out : line.entity->id == artefact_.corner_in)
        continue;
      truth.ends.push_back({line.entity->id, at_start, gapOf(line, at_start)});
    }
  }
  corner(truth);
}

double ArtefactCut::beforeCorner() const {
  const Cut cut = cutOfCorner();
  return corner_mm_ > 0.0 ? cut.radius_mm * std::tan(0.5 * cut.turn_rad) : corner_mm_;
}

ArtefactCut::Cut ArtefactCut::cutOfCorner() const {
  const Vector2d t_in =
      dieline::tangentAt(lines_[static_cast<std::size_t>(artefact_.corner_in)].entity->curve, 1.0);
  const Vector2d t_out =
      dieline::tangentAt(lines_[static_cast<std::size_t>(artefact_.corner_out)].entity->curve, 0.0);
  Cut cut;
  cut.tangent_in = t_in;
  cut.side = (t_out - t_out.dot(t_in) * t_in).normalized();
  cut.turn_rad = std::acos(std::clamp(t_in.dot(t_out), -1.0, 1.0));
  cut.radius_mm = std::max(corner_mm_, 0.0) / (1.0 / std::cos(0.5 * cut.turn_rad) - 1.0);
  return cut;
}

Vector2d ArtefactCut::arcShift(const Line& line, double s_mm) const {
  const bool in = line.entity->id == artefact_.corner_in;
  if (!(corner_mm_ > 0.0) || (!in && line.entity->id != artefact_.corner_out)) return Vector2d::Zero();
  const double from_corner_mm = in ? line.length_mm - s_mm : s_mm;
  const Cut cut = cutOfCorner();
  const double along_mm = std::min({cut.radius_mm, beforeCorner(), beforeCorner() - from_corner_mm});
  if (!(along_mm > 0.0)) return Vector2d::Zero();
  // The inside of the turn, square to the leg.
  const double side = leftOf(cut.tangent_in).dot(cut.side) > 0.0 ? 1.0 : -1.0;
  const Vector2d inwards = side * leftOf(dieline::tangentAt(line.entity->curve, s_mm / line.length_mm));
  return (cut.radius_mm - std::sqrt(cut.radius_mm * cut.radius_mm - along_mm * along_mm)) * inwards;
}

void ArtefactCut::addArc(std::vector<Vector2d>& way) const {
  if (!(corner_mm_ > 0.0)) return;
  const Line& in = lines_[static_cast<std::size_t>(artefact_.corner_in)];
  const Line& on = lines_[static_cast<std::size_t>(artefact_.corner_out)];
  const Cut cut = cutOfCorner();
  const double before_mm = beforeCorner();
  // Fine steps, and one point on the bisector: the path's distance from the corner is that of its points.
  const int pieces =
      2 * std::max(2, static_cast<int>(std::ceil(cut.radius_mm * cut.turn_rad / (0.5 * kStep_mm))));
  const Vector2d begin = dieline::pointAt(in.entity->curve, 1.0) - before_mm * cut.tangent_in;
  const Vector2d shift_in = shiftAt(in, in.length_mm - before_mm);
  const Vector2d shift_on = shiftAt(on, before_mm);
  for (int i = 1; i <= pieces; ++i) {
    const double share = static_cast<double>(i) / pieces;
    const double angle = cut.turn_rad * share;
    way.push_back(begin +
                  cut.radius_mm * (std::sin(angle) * cut.tangent_in + (1.0 - std::cos(angle)) * cut.side) +
                  (1.0 - share) * shift_in + share * shift_on);
  }
}

void ArtefactCut::corner(CutTruth& truth) const {
  const Line& in = lines_[static_cast<std::size_t>(artefact_.corner_in)];
  const Line& on = lines_[static_cast<std::size_t>(artefact_.corner_out)];
  const Vector2d nominal = dieline::pointAt(in.entity->curve, 1.0);
  const Vector2d t_in = dieline::tangentAt(in.entity->curve, 1.0);
  const Vector2d t_out = dieline::tangentAt(on.entity->curve, 0.0);
  const Vector2d shift_in = shiftAt(in, in.length_mm);
  const Vector2d shift_on = shiftAt(on, 0.0);
  truth.corner_shift_mm = std::max(shift_in.norm(), shift_on.norm());
  // Where the legs as cut would meet if they ran straight on.
  const Vector2d at_in = pathAt(in, in.length_mm);
  const Vector2d at_on = pathAt(on, 0.0);
  Eigen::Matrix2d normals;
  normals << leftOf(at_in - pathAt(in, in.length_mm - kFine_mm)).normalized().transpose(),
      leftOf(pathAt(on, kFine_mm) - at_on).normalized().transpose();
  const Vector2d vertex = normals.inverse() * Vector2d(normals.row(0).dot(at_in), normals.row(1).dot(at_on));
  const double before_mm = beforeCorner();
  std::vector<Vector2d> turn{pathAt(in, in.length_mm - before_mm)};
  addArc(turn);
  turn.push_back(pathAt(on, before_mm));
  std::vector<Vector2d> way = turn;
  for (int i = 0; i < static_cast<int>(kLeg_mm / kFine_mm); ++i) {
    const double s_mm = i * kFine_mm;
    way.push_back(pathAt(in, in.length_mm - before_mm - s_mm));
    way.push_back(pathAt(on, before_mm + s_mm));
  }
  const auto toWay = [&](const Vector2d& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vector2d& w : way) least = std::min(least, (w - p).norm());
    return least;
  };
  truth.corner_mm = toWay(nominal);
  for (const Vector2d& p : way) {
    const Vector2d d = p - nominal;
    if (std::max(-d.dot(t_in), d.dot(t_out)) > kNearCorner_mm) continue;  // Calipers judge there.
    truth.corner_mm = std::max(truth.corner_mm, std::min(distanceToRay(d, -t_in), distanceToRay(d, t_out)));
  }
  truth.rounding_mm = corner_mm_ > 0.0 ? toWay(vertex) : 0.0;
  truth.overshoot_mm =
      corner_mm_ > 0.0
          ? 0.0
          : std::max({0.0, (turn.front() - vertex).dot(t_in), (vertex - turn.back()).dot(t_out)});
}

double CutTruth::worstJoint_mm() const {
  double worst = corner_mm;
  for (const End& end : ends) worst = std::max(worst, std::abs(end.gap_mm));
  return worst;
}

CutTruth ArtefactCut::truth(const std::vector<vision::EntityKerf>& stations,
                            const twin::BoardDescription& board, double nominal_radius_mm) const {
  CutTruth truth;
  double squares = 0.0;
  double count = 0.0;
  for (const vision::EntityKerf& kerf : stations) {
    const Line& line = lines_.at(static_cast<std::size_t>(kerf.entity));
    EntityTruth e{.entity = kerf.entity, .circularity_mm = std::numeric_limits<double>::quiet_NaN()};
    const double share = shareOf(line.entity->process, board, beam_);
    double own_squares = 0.0;
    double own = 0.0;
    for (const vision::Caliper& c : kerf.calipers) {
      const double offset_mm = offsetAt(line, c.station_mm);
      e.offset_mm.push_back(offset_mm);
      if (c.near_joint || !judged(line, c.station_mm)) continue;
      e.worst_mm = std::max(e.worst_mm, std::abs(offset_mm));
      own_squares += offset_mm * offset_mm;
      e.width_mm += widthAt(line, c.station_mm, share * nominal_radius_mm, board);
      own += 1.0;
    }
    e.rms_mm = std::sqrt(own_squares / own);
    e.width_mm /= own;
    squares += own_squares;
    count += own;
    truth.worst_mm = std::max(truth.worst_mm, e.worst_mm);
    if (dieline::isClosed(line.entity->curve)) {
      // Least-squares circle: mean and first harmonic, over even stations.
      Eigen::MatrixXd basis(static_cast<Eigen::Index>(e.offset_mm.size()), 3);
      for (Eigen::Index i = 0; i < basis.rows(); ++i) {
        const double angle = kTurn_rad * kerf.calipers[static_cast<std::size_t>(i)].u;
        basis.row(i) << 1.0, std::cos(angle), std::sin(angle);
      }
      const Eigen::Map<const Eigen::VectorXd> x(e.offset_mm.data(), basis.rows());
      const Eigen::VectorXd rest =
          x - basis * (basis.transpose() * basis).ldlt().solve(basis.transpose() * x);
      e.circularity_mm = rest.maxCoeff() - rest.minCoeff();
    }
    truth.entities.push_back(std::move(e));
  }
  truth.rms_mm = std::sqrt(squares / count);
  joints(truth);
  return truth;
}

double ArtefactCut::worst_mm(double pitch_mm) const {
  CutTruth truth;
  joints(truth);
  double worst = truth.worstJoint_mm();
  for (const Line& line : lines_) {
    const auto steps = static_cast<int>(std::ceil(line.length_mm / pitch_mm));
    for (int i = 0; i <= steps; ++i) {
      const double s_mm = line.length_mm * i / steps;
      if (judged(line, s_mm)) worst = std::max(worst, std::abs(offsetAt(line, s_mm)));
    }
  }
  return worst;
}

void ArtefactCut::burnWay(twin::Sheet& sheet, const std::vector<Vector2d>& way, const Line& line,
                          double from_s_mm, double energy_j_mm) const {
  const auto footprint = [&](const Vector2d& p) {
    return twin::Footprint{p, beam_.radius_x_mm, beam_.radius_y_mm, beam_.correlation};
  };
  double s_mm = from_s_mm;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const double step_mm = (way[i + 1] - way[i]).norm();
    sheet.burn(footprint(way[i]), footprint(way[i + 1]),
               energy_j_mm * step_mm * relativePower(line, s_mm + 0.5 * step_mm));
    s_mm += step_mm;
  }
}

void ArtefactCut::burn(twin::Sheet& sheet, double nominal_radius_mm) const {
  const double cutting_j_mm =
      sheet.board().cut_fluence_j_mm2 * nominal_radius_mm * std::sqrt(0.5 * std::numbers::pi);
  const Line& first = lines_[static_cast<std::size_t>(artefact_.corner_in)];
  const Line& second = lines_[static_cast<std::size_t>(artefact_.corner_out)];
  const double before_mm = beforeCorner();
  for (const Line& line : lines_) {
    const double share = shareOf(line.entity->process, sheet.board(), beam_);
    double from = line.start_gap_mm;
    double to = line.length_mm - line.end_gap_mm;
    if (&line == &first) to -= before_mm;
    if (&line == &second) from += before_mm;
    const auto steps = static_cast<int>(std::ceil((to - from) / kStep_mm));
    std::vector<Vector2d> way;
    for (int i = 0; i <= steps; ++i) way.push_back(pathAt(line, from + (to - from) * i / steps));
    // From the end of one leg to that of the other, wherever they were shifted to.
    if (&line == &first) addArc(way);
    burnWay(sheet, way, line, from, share * cutting_j_mm);
  }
}

}  // namespace kerfbench::gauge
