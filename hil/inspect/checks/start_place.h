// SPDX-License-Identifier: Apache-2.0
#pragma once

// Where a beam rests before it sets off along a line. Private to hil/inspect and its tests.

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/results.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/verdict/tolerances.h"

namespace kerfbench::inspect::checks {

/// Way from the nominal start of a line, along it.
struct StartPlace {
  double mm{};  ///< > 0: inside of the line.
  double sigma_mm{};
};

/// How far the lines of each unit lie displaced on the sheet, by the spot's deviations across them: the place
/// of a start along its own line, which no deviation across that line tells, is told by lines that run
/// another way.
///
/// Least squares over one displacement d of the unit: the mean deviation of line l with the left normal n_l
/// is n_l · d. Before anything is read, d is zero within half of the largest deviation that was read, of a
/// line or of an end, but no more than half of the path's limit: what lies farther off fails by itself. So d
/// is as unknown as that along lines that have no other across them. How well lines keep to one displacement
/// is part of the uncertainty.
class Displacements {
 public:
  /// `joints`: measureJoints() of the same evidence.
  Displacements(const Evidence& evidence, const std::vector<JointResult>& joints, const Tolerances& limits,
                const LitFrames& lit);

  /// Displacement of a unit along a direction on its sheet.
  [[nodiscard]] StartPlace along(int unit, const Eigen::Vector2d& direction) const;

 private:
  struct Fit {
    Eigen::Vector2d mm{Eigen::Vector2d::Zero()};
    Eigen::Matrix2d covariance{Eigen::Matrix2d::Zero()};
    double scatter_mm{};  ///< RMS of the lines about it.
  };
  std::map<int, Fit> fits_;
};

/// Where the kerf of a line begins, if its end was measured; with the uncertainty of the unit's place.
std::optional<StartPlace> kerfStart(const std::vector<JointResult>& joints, int unit, int entity,
                                    bool at_start);

}  // namespace kerfbench::inspect::checks
