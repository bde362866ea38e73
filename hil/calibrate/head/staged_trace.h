// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <ceres/jet.h>
#include <Eigen/Core>

#include "hil/calibrate/head/head_trace.h"
#include "hil/calibrate/head/model_solver.h"

namespace kerfbench::hil {

/// The trace with its derivatives by all departures, in three stages: each is differentiated by its own few
/// departures and the ray that enters it, and the chain rule joins them. A third of the work of carrying 32
/// derivatives through.
class StagedTrace {
 public:
  /// Departures are scaled · units; derivatives are by `scaled`.
  StagedTrace(const HeadDesign& design, const HeadVector& units, const double* scaled);

  /// False where the beam does not land.
  bool landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm, HeadJacobian& by_scaled) const;

 private:
  static constexpr int kRay = 6;
  using First = ceres::Jet<double, 12>;   ///< Throw, spacing, the first mirror's six, the beam's four.
  using Last = ceres::Jet<double, 14>;    ///< Ray, throw, the last mirror's six, and one to make it even.
  using Bare = ceres::Jet<double, 12>;    ///< Ray, the plane's six.
  using Lensed = ceres::Jet<double, 20>;  ///< Ray, the plane's six, the lens's eight.
  template <typename T>
  struct End {
    std::optional<trace::Lens<T>> lens;
    trace::Plane<T> plane;
  };
  template <typename T>
  static bool finish(const End<T>& end, const Eigen::Matrix<double, kRay, 1>& ray, Eigen::Vector2d& p_W_mm,
                     Eigen::Matrix<double, 2, T::DIMENSION>& slopes);

  std::vector<std::size_t> first_, last_,
      end_;  ///< Departures of each stage, in the order of its derivatives.
  trace::Ray<First> laser_;
  trace::Mirror<First> first_mirror_;
  trace::Mirror<Last> last_mirror_;
  std::optional<End<Bare>> bare_;
  std::optional<End<Lensed>> lensed_;
};

}  // namespace kerfbench::hil
