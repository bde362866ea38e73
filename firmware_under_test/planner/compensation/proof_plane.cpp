// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware_under_test/planner/compensation/plane_check.h"
#include "firmware_under_test/planner/compensation/proof_parts.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kFirstMm = 8.0;
constexpr double kSecondMm = 6.0;

/// Segment from `start` to `end` with the given sweep.
Segment pieceOf(const Vector2d& start, const Vector2d& end, double sweep_rad) {
  Segment piece;
  piece.start_mm = start;
  piece.end_mm = end;
  piece.sweep_rad = sweep_rad;
  piece.z = 1.0;
  if (sweep_rad == 0.0) return piece;
  const Vector2d chord = end - start;
  piece.centre_mm = start + 0.5 * (chord + Vector2d(-chord.y(), chord.x()) / std::tan(0.5 * sweep_rad));
  return piece;
}

std::string pairName(double first, double second) {
  return std::string(first == 0.0 ? "line" : "arc") + (second == 0.0 ? "-line" : "-arc");
}

PlaneProofRow& rowOf(Proof& proof, const std::string& pair, JointKind kind) {
  for (PlaneProofRow& row : proof.plane) {
    if (row.pair == pair && row.kind == kind) return row;
  }
  PlaneProofRow row;
  row.pair = pair;
  row.kind = kind;
  row.nearest_mm = 1.0;
  proof.plane.push_back(row);
  return proof.plane.back();
}

void tryJoint(Proof& proof, const Contour& contour, const std::string& pair, double radius_mm) {
  if (!contactFaults({contour}).empty()) return;
  const Offset offset = offsetContours({contour}, radius_mm);
  std::vector<std::vector<Segment>> paths;
  for (const BeamPath& path : offset.paths) paths.push_back(path.segments);
  const PlaneCheck check = checkPlane({contour}, paths, radius_mm);
  proof.plane_samples += check.samples;
  PlaneProofRow& row = rowOf(proof, pair, offset.joints.front().kind);
  ++row.joints;
  row.nearest_mm = std::min(row.nearest_mm, check.nearest_mm - radius_mm);
  row.farthest = std::max(row.farthest, check.farthest_mm / radius_mm);
  row.missed_mm = std::max(row.missed_mm, check.missed_mm);
  row.failed += check.holds(radius_mm) ? 0 : 1;
}

}  // namespace

Contour planeJoint(double turn_rad, double first_sweep_rad, double second_sweep_rad, Side side) {
  const double a = -0.5 * first_sweep_rad;
  const double b = turn_rad + 0.5 * second_sweep_rad;
  const Vector2d start = -kFirstMm * Vector2d(std::cos(a), std::sin(a));
  const Vector2d end = kSecondMm * Vector2d(std::cos(b), std::sin(b));
  return {
      {pieceOf(start, Vector2d::Zero(), first_sweep_rad), pieceOf(Vector2d::Zero(), end, second_sweep_rad)},
      side,
      false};
}

void provePlane(Proof& proof) {
  const int steps = static_cast<int>(180.0 / proof.grid.turn_step_deg);
  for (int i = 1 - steps; i < steps; ++i) {
    const double turn = i * proof.grid.turn_step_deg;
    for (const double first : {0.0, 0.8, -0.8}) {
      for (const double second : {0.0, 0.9, -0.9}) {
        for (const Side side : {Side::kLeft, Side::kRight}) {
          for (const double r : proof.grid.radii_mm) {
            const Contour contour = planeJoint(turn * kDeg, first, second, side);
            tryJoint(proof, healed(contour, 1e-6), pairName(first, second), 2.0 * r);
          }
        }
      }
    }
  }
  std::sort(proof.plane.begin(), proof.plane.end(), [](const PlaneProofRow& a, const PlaneProofRow& b) {
    return a.pair != b.pair ? a.pair > b.pair : a.kind < b.kind;
  });
}

Proof prove(const ProofGrid& grid) {
  Proof proof;
  proof.grid = grid;
  proveSpace(proof);
  provePlane(proof);
  return proof;
}

bool Proof::holds() const {
  const bool space_holds = std::all_of(space.begin(), space.end(), [](const SpaceProofRow& row) {
    return row.nearest > 1.0 - 1e-9 && row.missed < 1e-6;
  });
  const bool plane_holds =
      std::all_of(plane.begin(), plane.end(), [](const PlaneProofRow& row) { return row.failed == 0; });
  return space_holds && plane_holds && not_refused == 0 && unexpected.empty();
}

}  // namespace kerfbench::planner
