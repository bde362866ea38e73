// SPDX-License-Identifier: Apache-2.0
// The kerf scan as read at the edge of the wanted piece.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "hil/dieline/geometry.h"
#include "hil/inspect/edges/edges.h"
#include "hil/inspect/evidence/places.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Calipers of a leg whose mean tells where its edge lies at the corner.
constexpr std::size_t kLegReadings = 5;
// As deviations.cpp has them for widths, where their reasons stand.
constexpr double kFlanks = 1.4;
constexpr double kOwnBlurShare = 0.032;

constexpr double kAtCorner_mm = 0.02;  // Distance of ends that count as touching.

/// Edge of a corner's leg in the sense of the way through the corner.
struct Leg {
  Eigen::Vector2d normal{Eigen::Vector2d::Zero()};  ///< Left of the way.
  double edge_mm{kNan};                             ///< Along it.
  double sigma_mm{kNan};
  double half_kerf_mm{kNan};
  int side{};  ///< Side of the kerf, +1 left of the beam's direction.
};

int sideOf(const EdgeSides& sides, int entity) { return sides.side[static_cast<std::size_t>(entity)]; }

double edgeOf(const vision::Caliper& c, int side) { return c.offset_mm - 0.5 * side * c.width_mm; }

Leg legOf(const vision::KerfScan& scan, const dieline::Dieline& dieline, const EdgeSides& sides,
          const vision::CornerKerf& corner, bool incoming) {
  const int entity = incoming ? corner.entity_in : corner.entity_out;
  const dieline::Curve& curve = dieline.entities[static_cast<std::size_t>(entity)].curve;
  const bool at_end = (dieline::pointAt(curve, 1.0) - corner.p_S_mm).norm() <
                      (dieline::pointAt(curve, 0.0) - corner.p_S_mm).norm();
  // A corner within one entity, where a closed curve meets itself, is left by its start.
  const bool end = corner.entity_in == corner.entity_out ? incoming : at_end;
  const double sense = end == incoming ? 1.0 : -1.0;
  const Eigen::Vector2d t = sense * dieline::tangentAt(curve, end ? 1.0 : 0.0);
  Leg leg;
  leg.normal = {-t.y(), t.x()};
  leg.side = static_cast<int>(sense) * sideOf(sides, entity);
  const auto kerf =
      std::find_if(scan.entities.begin(), scan.entities.end(),
                   [&](const vision::EntityKerf& k) { return k.unit == corner.unit && k.entity == entity; });
  if (kerf == scan.entities.end()) return leg;
  double edge_mm = 0.0;
  double sigma_mm = 0.0;
  double width_mm = 0.0;
  std::size_t n = 0;
  const std::size_t count = kerf->calipers.size();
  for (std::size_t i = 0; i < count && n < kLegReadings; ++i) {
    const vision::Caliper& c = kerf->calipers[end ? count - 1 - i : i];
    if (!judgesOffset(c) || !std::isfinite(c.width_mm)) continue;
    ++n;
    edge_mm += sense * edgeOf(c, sideOf(sides, entity));
    sigma_mm += std::hypot(c.sigma_mm, 0.5 * c.width_sigma_mm);
    width_mm += c.width_mm;
  }
  if (n < kLegReadings) return leg;
  const auto N = static_cast<double>(n);
  leg.edge_mm = edge_mm / N;
  leg.half_kerf_mm = 0.5 * width_mm / N;
  // What readings have in common does not average out.
  leg.sigma_mm =
      std::hypot(sigma_mm / N, 0.5 * std::hypot(kerf->widening_sigma_mm, kOwnBlurShare * kerf->widening_mm));
  return leg;
}

/// Turn of the path out of an end of `curve` into a cut that begins or ends there but is not
/// selected; 0 if there is none. No corner of the scan tells of it.
double turnIntoLeftOut(const dieline::Dieline& dieline, const dieline::Curve& curve, bool at_start) {
  const Eigen::Vector2d end_mm = dieline::pointAt(curve, at_start ? 0.0 : 1.0);
  const Eigen::Vector2d out = (at_start ? -1.0 : 1.0) * dieline::tangentAt(curve, at_start ? 0.0 : 1.0);
  for (const dieline::Entity& other : dieline.entities) {
    if (other.left_out != dieline::Process::kCut) continue;
    for (const double u : {0.0, 1.0}) {
      if ((dieline::pointAt(other.curve, u) - end_mm).norm() > kAtCorner_mm) continue;
      const Eigen::Vector2d on = (u == 0.0 ? 1.0 : -1.0) * dieline::tangentAt(other.curve, u);
      return std::atan2(out.x() * on.y() - out.y() * on.x(), out.dot(on));
    }
  }
  return 0.0;
}

void readAtEdge(const Leg& in, const Leg& out, vision::CornerKerf& corner) {
  if (!corner.found || in.side == 0 || in.side != out.side) return;
  Eigen::Matrix2d normals;
  normals.row(0) = in.normal.transpose();
  normals.row(1) = out.normal.transpose();
  const Eigen::Vector2d d_mm = normals.inverse() * Eigen::Vector2d(in.edge_mm, out.edge_mm);
  const double half_kerf_mm = 0.5 * (in.half_kerf_mm + out.half_kerf_mm);
  const double by_kerf_mm = half_kerf_mm * (1.0 / std::cos(0.5 * corner.turn_rad) - 1.0);
  const double turn = corner.turn_rad > 0.0 ? 1.0 : -1.0;
  const bool kerf_inside_turn = in.side * turn > 0.0;
  const double rounding_mm =
      kerf_inside_turn ? corner.rounding_mm + by_kerf_mm : std::max(0.0, corner.rounding_mm - by_kerf_mm);
  const Eigen::Vector2d inwards = turn * (in.normal + out.normal).normalized();
  corner.deviation_mm =
      std::max({std::abs(in.edge_mm), std::abs(out.edge_mm), (d_mm + rounding_mm * inwards).norm()});
  corner.deviation_sigma_mm = std::hypot(std::max(in.sigma_mm, out.sigma_mm), corner.rounding_sigma_mm);
  if (kerf_inside_turn && corner.overshoot_mm > corner.deviation_mm) {
    corner.deviation_mm = corner.overshoot_mm;
    corner.deviation_sigma_mm = std::hypot(std::max(in.sigma_mm, out.sigma_mm), corner.overshoot_sigma_mm);
  }
  corner.found = std::isfinite(corner.deviation_mm) && std::isfinite(corner.deviation_sigma_mm);
}

/// The edge is one flank of the kerf.
void addFlankErrors(const vision::EntityKerf& kerf, ReadingLine& line) {
  const double blur_mm = 0.5 * kOwnBlurShare * kerf.widening_mm;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const vision::Caliper& c = kerf.calipers[line.caliper[i]];
    const double steady_mm = std::min(kFlanks * c.steady_sigma_mm, c.width_sigma_mm);
    const double noise_mm = std::sqrt(c.width_sigma_mm * c.width_sigma_mm - steady_mm * steady_mm);
    line.sigma_mm[i] = std::hypot(line.sigma_mm[i], 0.5 * noise_mm);
    if (line.shared.rows() == 0) continue;
    auto own = line.shared.row(static_cast<Eigen::Index>(i)).head<ReadingLine::kLine>();
    Eigen::Index direction = 0;
    own.cwiseAbs().maxCoeff(&direction);
    own[direction] = std::hypot(own[direction], std::hypot(0.5 * steady_mm, blur_mm));
  }
}

}  // namespace

vision::KerfScan edgeScan(const vision::KerfScan& scan, const dieline::Dieline& dieline,
                          const EdgeSides& sides) {
  vision::KerfScan edges = scan;
  for (vision::EntityKerf& kerf : edges.entities) {
    const int side = sideOf(sides, kerf.entity);
    if (side == 0) continue;
    for (vision::Caliper& c : kerf.calipers) {
      if (!c.found) continue;
      // For a kerf without a width this is no number, and the evidence INVALID.
      c.offset_mm = edgeOf(c, side);
    }
  }
  for (vision::CornerKerf& corner : edges.corners)
    readAtEdge(legOf(scan, dieline, sides, corner, true), legOf(scan, dieline, sides, corner, false), corner);
  return edges;
}

void addWidthErrors(const vision::KerfScan& scan, const EdgeSides& sides, ErrorModel& model) {
  model.make = [&scan, &sides, make = std::move(model.make)](std::size_t number, ErrorModel::Part part) {
    ReadingLine line = make(number, part);
    const vision::EntityKerf& kerf = scan.entities[line.kerf];
    if (sideOf(sides, kerf.entity) != 0) addFlankErrors(kerf, line);
    return line;
  };
}

void addBlurUncertainty(const vision::KerfScan& scan, const EdgeSides& sides, double limit_mm,
                        DeviationResult& result) {
  double sigma_mm = 0.0;
  for (const vision::EntityKerf& kerf : scan.entities) {
    if (sideOf(sides, kerf.entity) != 0) sigma_mm = std::max(sigma_mm, 0.5 * kerf.widening_sigma_mm);
  }
  const auto widen = [&](DeviationEstimate& e) {
    e.worst.U = std::hypot(e.worst.U, 2.0 * sigma_mm);
    e.rms.U = std::hypot(e.rms.U, 2.0 * sigma_mm);
  };
  for (std::size_t l = 0; l < result.lines.size(); ++l) {
    if (sideOf(sides, scan.entities[l].entity) != 0) widen(result.lines[l]);
  }
  for (DeviationEstimate& e : result.layers) widen(e);
  widen(result.all);
  result.chance_beyond = chanceAboveNormal(limit_mm, result.all.worst);
  UncertaintyBudget& budget = result.budget;
  if (budget.entries.empty()) return;
  budget.quantity = "worst deviation of all edges";
  budget.entries.push_back({"blur of the picture, which widens all kerfs alike", sigma_mm, 0.0});
  budget.analytic_U = std::hypot(budget.analytic_U, 2.0 * sigma_mm);
  budget.monte_carlo_U = std::hypot(budget.monte_carlo_U, 2.0 * sigma_mm);
}

double halfKerf(const vision::KerfScan& scan, const EdgeSides& sides) {
  double sum_mm = 0.0;
  double n = 0.0;
  for (const vision::EntityKerf& kerf : scan.entities) {
    if (sideOf(sides, kerf.entity) == 0) continue;
    for (const vision::Caliper& c : kerf.calipers) {
      if (!judgesOffset(c) || !std::isfinite(c.width_mm)) continue;
      sum_mm += c.width_mm;
      n += 1.0;
    }
  }
  return 0.5 * sum_mm / n;
}

void measureFromBeamLine(const EdgeSides& sides, double half_kerf_mm, LitFrames& lit) {
  if (!std::isfinite(half_kerf_mm)) return;
  for (LitFrame& frame : lit.frames) {
    const int entity = frame.entity >= 0 ? frame.entity : frame.left_entity;
    if (entity >= 0) frame.deviation_mm -= sideOf(sides, entity) * half_kerf_mm;
  }
}

void measureFromOwnKerf(const vision::KerfScan& edge_scan, const EdgeSides& sides, LitFrames& lit) {
  std::map<std::pair<int, int>, double> centre_mm;
  for (const vision::EntityKerf& kerf : edge_scan.entities) {
    const int side = sideOf(sides, kerf.entity);
    if (side == 0) continue;
    double sum_mm = 0.0;
    double n = 0.0;
    for (const vision::Caliper& c : kerf.calipers) {
      if (!judgesOffset(c)) continue;
      sum_mm += c.offset_mm + 0.5 * side * c.width_mm;
      n += 1.0;
    }
    if (n > 0.0) centre_mm[{kerf.unit, kerf.entity}] = sum_mm / n;
  }
  for (LitFrame& frame : lit.frames) {
    const auto own = centre_mm.find({frame.unit, frame.entity >= 0 ? frame.entity : frame.left_entity});
    if (own != centre_mm.end()) frame.deviation_mm -= own->second;
  }
}

double shortenedBy(const vision::KerfScan& scan, const dieline::Dieline& dieline, const EdgeSides& sides,
                   double half_kerf_mm, const vision::EntityKerf& kerf, bool at_start) {
  const dieline::Curve& curve = dieline.entities[static_cast<std::size_t>(kerf.entity)].curve;
  const Eigen::Vector2d end_mm = dieline::pointAt(curve, at_start ? 0.0 : 1.0);
  for (const vision::CornerKerf& corner : scan.corners) {
    const bool incoming = corner.entity_in == kerf.entity;
    if (corner.unit != kerf.unit || !(incoming || corner.entity_out == kerf.entity)) continue;
    if ((corner.p_S_mm - end_mm).norm() > kAtCorner_mm) continue;
    const double sense = incoming == at_start ? -1.0 : 1.0;
    if (sense * sideOf(sides, kerf.entity) * corner.turn_rad > 0.0)
      return half_kerf_mm * std::tan(0.5 * std::abs(corner.turn_rad));
  }
  const double turn_rad = turnIntoLeftOut(dieline, curve, at_start);
  if ((at_start ? -1.0 : 1.0) * sideOf(sides, kerf.entity) * turn_rad > 0.0)
    return half_kerf_mm * std::tan(0.5 * std::abs(turn_rad));
  return 0.0;
}

Check edgeCheck(Check path, const EdgeSides& sides, double half_kerf_mm, double half_light_mm) {
  path.name = "edge";
  path.title = "Deviation of the wanted piece's edge from the dieline";
  path.explanation += fmt::format(
      " Judged is the kerf's edge on the piece's side, not its centre: kerf outside of {} closed "
      "cuts, inside of {}; half a kerf is {:.4f} mm wide where the board is severed",
      sides.outlines, sides.holes, half_kerf_mm);
  path.explanation += half_kerf_mm < half_light_mm
                          ? fmt::format(", {:.4f} mm where half of the light comes through.", half_light_mm)
                          : " by the light, as nothing is known of the beam.";
  if (sides.open_beside > 0)
    path.explanation += fmt::format(" {} open cuts have the kerf beside them, on the side that was ordered.",
                                    sides.open_beside);
  if (sides.open > 0)
    path.explanation +=
        fmt::format(" {} open cuts have no inside and are judged by their centre.", sides.open);
  return path;
}

}  // namespace kerfbench::inspect::checks
