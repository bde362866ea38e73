// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/compensation/proof_parts.h"
#include "firmware_under_test/planner/compensation/space_check.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Length of the lines in radii, enough for the joints of all corners tried.
constexpr double kLength = 400.0;

/// Paper's joint with the strict offsets before and behind it.
std::vector<SpacePoint> paperPoints(const SpaceCorner& corner, const PaperPath& paper, double radius_mm) {
  const double mirror = corner.side == Side::kLeft ? 1.0 : -1.0;
  const auto offset = [&](const Vector3d& p, const Vector3d& from, const Vector3d& to, const Vector3d& n) {
    return SpacePoint{p + mirror * radius_mm * n.cross((to - from).normalized()), n};
  };
  const auto at = [&](const Vector2d& p, const Vector3d& h, const Vector3d& n) {
    return SpacePoint{corner.b + p.x() * corner.along + p.y() * h, n};
  };
  std::vector<SpacePoint> points{offset(corner.a, corner.a, corner.b, corner.n1)};
  for (const Vector2d& p : paper.first) points.push_back(at(p, corner.h1, corner.n1));
  points.push_back(at({paper.fold_mm, 0.0}, corner.h1, corner.n1));
  points.push_back(at({paper.fold_mm, 0.0}, corner.h2, corner.n2));
  for (auto p = paper.second.rbegin(); p != paper.second.rend(); ++p) {
    points.push_back(at(*p, corner.h2, corner.n2));
  }
  points.push_back(offset(corner.c, corner.b, corner.c, corner.n2));
  return points;
}

SpaceProofRow& rowOf(Proof& proof, const FoldCorner& corner) {
  const int number = corner.number();
  for (SpaceProofRow& row : proof.space) {
    if (row.number == number) return row;
  }
  SpaceProofRow row;
  row.number = number;
  row.joint = corner.joint();
  row.nearest = row.paper_nearest = row.paper_nearest_above = std::numeric_limits<double>::infinity();
  proof.space.push_back(row);
  return proof.space.back();
}

void tryCorner(Proof& proof, const FoldCorner& angles, double radius_mm, Side side) {
  const SpaceCorner corner = SpaceCorner::of(angles, kLength * radius_mm, side);
  SpacePath path;
  try {
    path = offsetInSpace(corner.contour(), radius_mm);
  } catch (const CompensationError& error) {
    proof.unexpected.push_back(fmt::format("alpha {:g}°, beta {:g}°, Omega {:g}°, r {:g} mm: {}",
                                           angles.alpha_rad / kDeg, angles.beta_rad / kDeg,
                                           angles.omega_rad / kDeg, radius_mm, error.what()));
    return;
  }
  SpaceProofRow& row = rowOf(proof, angles);
  const SpaceCheck check = checkCorner(corner, path.points, radius_mm);
  proof.space_samples += check.samples;
  ++row.corners;
  row.drawn_back += path.joints.front().drawn_back ? 1 : 0;
  row.nearest = std::min(row.nearest, check.nearest_mm / radius_mm);
  row.missed = std::max(row.missed, std::max(check.missed_mm, check.off_surface_mm) / radius_mm);
  const FoldPath parts = foldPath(angles, radius_mm);
  row.most_points = std::max({row.most_points, parts.first.size(), parts.second.size()});

  const PaperPath paper = paperPath(angles, radius_mm);
  if (!paper.exists) return;
  ++row.paper_corners;
  const SpaceCheck literal = checkCorner(corner, paperPoints(corner, paper, radius_mm), radius_mm);
  proof.space_samples += literal.samples;
  row.paper_missed = std::max(row.paper_missed, literal.missed_mm / radius_mm);
  const double nearest = literal.nearest_mm / radius_mm;
  if (angles.omega_rad > 1.5 * std::numbers::pi + 1e-9) {
    row.paper_nearest_above = std::min(row.paper_nearest_above, nearest);
  } else if (nearest < row.paper_nearest) {
    row.paper_nearest = nearest;
    row.paper_worst = angles;
  }
}

}  // namespace

void proveSpace(Proof& proof) {
  const ProofGrid& grid = proof.grid;
  const auto forAngles = [&](const auto& with) {
    const int steps = static_cast<int>(180.0 / grid.fold_step_deg);
    for (int i = 0; i < steps; ++i) {
      for (int k = 0; k < steps; ++k) {
        for (const Side side : {Side::kLeft, Side::kRight}) {
          with((i + 0.5) * grid.fold_step_deg, (k + 0.5) * grid.fold_step_deg, side);
        }
      }
    }
  };
  forAngles([&](double alpha, double beta, Side side) {
    for (const double omega : grid.omegas_deg) {
      for (const double r : grid.radii_mm)
        tryCorner(proof, {alpha * kDeg, beta * kDeg, omega * kDeg}, r, side);
    }
    for (const double omega : grid.refused_deg) {
      const FoldCorner angles{alpha * kDeg, beta * kDeg, omega * kDeg};
      try {
        offsetInSpace(SpaceCorner::of(angles, 40.0, side).contour(), 0.1);
        ++proof.not_refused;
      } catch (const CompensationError&) {
        ++proof.refused;
      }
    }
  });
  std::sort(proof.space.begin(), proof.space.end(),
            [](const SpaceProofRow& a, const SpaceProofRow& b) { return a.number < b.number; });
}

}  // namespace kerfbench::planner
