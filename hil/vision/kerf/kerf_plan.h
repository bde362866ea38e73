// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/process.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::vision {

/// A place on the dieline where a caliper shall lie.
struct Station {
  double u{};
  double station_mm{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d tangent{Eigen::Vector2d::UnitX()};
  double curvature_per_mm{};
  bool
      near_corner{};  ///< True within the clearance of a corner, and where a cut lies on a line that is none.
  std::size_t hidden_begin{};
  std::size_t hidden_count{};  ///< Number of entries of EntityPlan::hidden_S_mm.
};

struct EntityPlan {
  int entity{};
  dieline::Process process{dieline::Process::kCut};
  double length_mm{};
  bool closed{};
  std::vector<Station> stations;
  /// Stations at which the light of a perforation is read, no more than kLightPitchMm apart; empty for
  /// others.
  std::vector<Station> light_stations;
  std::vector<Eigen::Vector2d> hidden_S_mm;

  /// Points of other curves, and of far parts of this one, that a station's caliper meets.
  [[nodiscard]] std::span<const Eigen::Vector2d> hidden(const Station& station) const {
    return std::span(hidden_S_mm).subspan(station.hidden_begin, station.hidden_count);
  }
};

/// One end of an entity.
struct EntityEnd {
  std::size_t plan{};  ///< Index into KerfPlan::entities.
  bool at_start{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d outward{Eigen::Vector2d::UnitX()};  ///< Unit tangent, out of the entity.
};

/// Two ends that meet at an angle, with nothing else near.
struct PlannedCorner {
  EntityEnd in;
  EntityEnd out;
  Eigen::Vector2d tangent_in{Eigen::Vector2d::UnitX()};   ///< Direction of the beam towards the corner.
  Eigen::Vector2d tangent_out{Eigen::Vector2d::UnitX()};  ///< Direction of the beam away from the corner.
  double turn_rad{};
};

struct KerfPlan {
  std::vector<EntityPlan> entities;
  std::vector<PlannedCorner> corners;
  std::vector<EntityEnd> free_ends;  ///< Ends with no other curve near.
  std::vector<EntityEnd> closures;   ///< Starts of closed entities that go round smoothly.
};

/// A pixel so near to a point of another curve may belong to the kerf of that: half a usual kerf, its blur
/// and its error.
inline constexpr double kHiddenMm = 0.2;
/// Half a caliper's length: with overlapping windows the light falls along a straight line where a cut ends,
/// and is half where it does.
inline constexpr double kLightPitchMm = 0.1;
/// Reach of a caliper that must be seen, to both sides, so that it is measured; the same for the own kerf.
inline constexpr double kOwnMm = 0.16;

/// Stations of all entities that are not kIgnore, and where they meet. A tangent continuation is neither
/// corner nor end.
KerfPlan planKerf(const dieline::Dieline& dieline, const KerfScanOptions& options);

}  // namespace kerfbench::vision
