// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace kerfbench::hil {
namespace {

constexpr double kSamplePitchMm = 0.1;
constexpr double kReachMarginMm = 0.15;  // half a kerf that only just begins beyond the caliper's end
constexpr double kAlongMm =
    0.25;  // half the length of curve that a profile is averaged over, and half a kerf
constexpr double kParallelSine = 0.14;  // 8 degrees
constexpr double kSameLineMm = 0.03;

/// A piece of curve, short against a caliper.
struct Sample {
  Eigen::Vector2d p_S_mm;
  Eigen::Vector2d tangent;
  double curvature_per_mm;
  double station_mm;
  std::size_t plan;
};

class SampleGrid {
 public:
  explicit SampleGrid(double cell_mm) : cell_mm_(cell_mm) {}

  void add(const Sample& sample) {
    cells_[key(index(sample.p_S_mm.x()), index(sample.p_S_mm.y()))].push_back(sample);
  }

  /// Whether any sample in the cells around satisfies the test.
  template <typename Test>
  [[nodiscard]] bool anyAround(const Eigen::Vector2d& p_mm, const Test& test) const {
    const std::int64_t cx = index(p_mm.x());
    const std::int64_t cy = index(p_mm.y());
    for (std::int64_t y = cy - 1; y <= cy + 1; ++y) {
      for (std::int64_t x = cx - 1; x <= cx + 1; ++x) {
        const auto cell = cells_.find(key(x, y));
        if (cell != cells_.end() && std::any_of(cell->second.begin(), cell->second.end(), test)) return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] std::int64_t index(double mm) const {
    return static_cast<std::int64_t>(std::floor(mm / cell_mm_));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffULL);
  }
  double cell_mm_;
  std::unordered_map<std::uint64_t, std::vector<Sample>> cells_;
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Arc length between two near parameters, by Simpson's rule.
double stretch(const Curve& curve, double u0, double u1) {
  return (u1 - u0) / 6.0 *
         (derivativeAt(curve, u0).norm() + 4.0 * derivativeAt(curve, 0.5 * (u0 + u1)).norm() +
          derivativeAt(curve, u1).norm());
}

std::vector<Station> stationsOf(const Curve& curve, double pitch_mm, double length_mm) {
  std::vector<Station> out;
  double s = 0.0;
  double before = 0.0;
  for (const double u : stations(curve, pitch_mm)) {
    if (!out.empty()) s += stretch(curve, before, u);
    before = u;
    out.push_back({u, s, pointAt(curve, u), tangentAt(curve, u), curvatureAt(curve, u), false});
  }
  // What Simpson's rule leaves is spread along the curve.
  if (s > 0.0) {
    for (Station& station : out) station.station_mm *= length_mm / s;
  }
  return out;
}

bool nearJoint(const Station& at, std::size_t plan, const EntityPlan& own, const SampleGrid& grid,
               const KerfScanOptions& options) {
  const double across_mm = options.reach_mm + kReachMarginMm;
  return grid.anyAround(at.p_S_mm, [&](const Sample& other) {
    const Eigen::Vector2d d = other.p_S_mm - at.p_S_mm;
    const double along = std::abs(d.dot(at.tangent));
    const double across = std::abs(cross(at.tangent, d));
    const bool in_caliper = across <= across_mm && along <= kAlongMm + 0.5 * kSamplePitchMm;
    if (other.plan == plan) {
      double apart_mm = std::abs(other.station_mm - at.station_mm);
      if (own.closed) apart_mm = std::min(apart_mm, own.length_mm - apart_mm);
      return in_caliper && apart_mm > 2.0 * across_mm;
    }
    const double bend = std::max(std::abs(at.curvature_per_mm), std::abs(other.curvature_per_mm));
    const bool parallel = std::abs(cross(at.tangent, other.tangent)) < kParallelSine + bend * d.norm();
    if (parallel && across <= kSameLineMm + 0.75 * bend * along * along) return false;
    return in_caliper || d.norm() <= options.joint_clearance_mm;
  });
}

}  // namespace

std::vector<EntityPlan> planStations(const Dieline& dieline, const KerfScanOptions& options) {
  std::vector<EntityPlan> plans;
  const double reach_mm = std::hypot(options.reach_mm + kReachMarginMm, kAlongMm + kSamplePitchMm);
  SampleGrid grid(std::max({1.0, reach_mm, options.joint_clearance_mm}));
  for (const Entity& entity : dieline.entities) {
    if (entity.process == Process::kIgnore) continue;
    EntityPlan plan;
    plan.entity = entity.id;
    plan.length_mm = lengthOf(entity.curve);
    plan.closed = isClosed(entity.curve);
    plan.stations = stationsOf(entity.curve, options.station_pitch_mm, plan.length_mm);
    for (const Station& s : stationsOf(entity.curve, kSamplePitchMm, plan.length_mm)) {
      grid.add({s.p_S_mm, s.tangent, s.curvature_per_mm, s.station_mm, plans.size()});
    }
    plans.push_back(std::move(plan));
  }
  for (std::size_t i = 0; i < plans.size(); ++i) {
    for (Station& station : plans[i].stations)
      station.near_joint = nearJoint(station, i, plans[i], grid, options);
  }
  return plans;
}

}  // namespace kerfbench::hil
