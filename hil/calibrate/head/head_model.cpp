// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/head_model.h"

#include "hil/calibrate/head/backward_trace.h"
#include "hil/calibrate/head/dual.h"
#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/head_trace.h"

namespace kerfbench::calibrate {
HeadModel::HeadModel(const HeadDesign& design) : design_(design) { check(design); }

std::optional<Eigen::Vector2d> HeadModel::landing_W_mm(const Eigen::Vector2d& angles_rad,
                                                       const HeadVector& departures) const {
  Eigen::Vector2d p_W_mm;
  const auto head = trace::headOf<double>(design_, departures.data());
  if (!trace::landing<double>(head, angles_rad, p_W_mm)) return std::nullopt;
  return p_W_mm;
}

std::optional<HeadModel::AngleSlopes> HeadModel::angleSlopesAt(const Eigen::Vector2d& angles_rad,
                                                               const HeadVector& departures) const {
  using Dual2 = Dual<2>;
  const Eigen::Matrix<Dual2, kHeadColumns, 1> fixed = departures.cast<Dual2>();
  const auto head = trace::headOf<Dual2>(design_, fixed.data());
  trace::Vector2<Dual2> p;
  if (!trace::landing<Dual2>(head, {Dual2(angles_rad.x(), 0), Dual2(angles_rad.y(), 1)}, p))
    return std::nullopt;
  AngleSlopes slopes{{p[0].value, p[1].value}, {}};
  slopes.by_angles << p[0].slopes.transpose(), p[1].slopes.transpose();
  return slopes;
}

std::optional<HeadModel::DepartureSlopes> HeadModel::departureSlopesAt(const Eigen::Vector2d& angles_rad,
                                                                       const HeadVector& departures) const {
  const BackwardTrace trace(design_, HeadVector::Ones(), departures.data());
  DepartureSlopes slopes;
  if (!trace.landing(angles_rad, slopes.p_W_mm, slopes.by_departures)) return std::nullopt;
  return slopes;
}

}  // namespace kerfbench::calibrate
