// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/staged_trace.h"

#include <array>
#include <optional>
#include <vector>

#include <ceres/jet.h>

#include "hil/calibrate/head/head_trace.h"

namespace kerfbench::hil {
namespace {

/// All departures as jets; those of a stage are its derivatives from `offset` on.
template <typename T>
std::array<T, kHeadParameterCount> seeded(const HeadVector& units, const double* scaled,
                                          const std::vector<std::size_t>& stage, int offset) {
  std::array<T, kHeadParameterCount> jets;
  for (std::size_t k = 0; k < kHeadParameterCount; ++k)
    jets[k] = T(scaled[k] * units[static_cast<Eigen::Index>(k)]);
  for (std::size_t i = 0; i < stage.size(); ++i)
    jets[stage[i]].v[offset + static_cast<int>(i)] = units[static_cast<Eigen::Index>(stage[i])];
  return jets;
}

void append(std::vector<std::size_t>& stage, HeadParameter first, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) stage.push_back(indexOf(first) + k);
}

template <typename T>
trace::Ray<T> rayOf(const Eigen::Matrix<double, 6, 1>& values) {
  trace::Ray<T> ray;
  for (int k = 0; k < 3; ++k) {
    ray.p_W_mm[k] = T(values[k], k);
    ray.direction[k] = T(values[3 + k], 3 + k);
  }
  return ray;
}

template <typename T>
void split(const trace::Ray<T>& ray, Eigen::Matrix<double, 6, 1>& values,
           Eigen::Matrix<double, 6, T::DIMENSION>& slopes) {
  for (int k = 0; k < 3; ++k) {
    values[k] = ray.p_W_mm[k].a;
    values[3 + k] = ray.direction[k].a;
    slopes.row(k) = ray.p_W_mm[k].v.transpose();
    slopes.row(3 + k) = ray.direction[k].v.transpose();
  }
}

void place(const auto& slopes, const std::vector<std::size_t>& stage, HeadJacobian& by_scaled) {
  for (std::size_t i = 0; i < stage.size(); ++i)
    by_scaled.col(static_cast<Eigen::Index>(stage[i])) += slopes.col(static_cast<Eigen::Index>(i));
}

}  // namespace

struct StagedTrace::Stages {
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
  std::vector<std::size_t> first_stage, last_stage,
      end_stage;  ///< Departures of each stage, in the order of its derivatives.
  trace::Ray<First> laser;
  trace::Mirror<First> first_mirror;
  trace::Mirror<Last> last_mirror;
  std::optional<End<Bare>> bare;
  std::optional<End<Lensed>> lensed;

  Stages(const HeadDesign& design, const HeadVector& units, const double* scaled);
  bool landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm, HeadJacobian& by_scaled) const;
  template <typename T>
  static bool finish(const End<T>& end, const Eigen::Matrix<double, kRay, 1>& ray, Eigen::Vector2d& p_W_mm,
                     Eigen::Matrix<double, 2, T::DIMENSION>& slopes);
};

StagedTrace::Stages::Stages(const HeadDesign& design, const HeadVector& units, const double* scaled) {
  const trace::Drawing drawing = trace::drawingOf(design);
  append(first_stage, HeadParameter::kThrow, 2);
  append(first_stage, trace::firstOfMirror(drawing.motors[0]), 6);
  append(first_stage, HeadParameter::kBeamOffsetA, 4);
  append(last_stage, HeadParameter::kThrow, 1);
  append(last_stage, trace::firstOfMirror(drawing.motors[1]), 6);
  append(end_stage, HeadParameter::kPlaneHeight, 6);
  const auto first = seeded<First>(units, scaled, first_stage, 0);
  laser = trace::laserOf<First>(design, first.data());
  first_mirror = trace::mirrorOf<First>(design, 0, first.data());
  last_mirror = trace::mirrorOf<Last>(design, 1, seeded<Last>(units, scaled, last_stage, kRay).data());
  if (!design.lens) {
    const auto end = seeded<Bare>(units, scaled, end_stage, kRay);
    bare = {std::nullopt, trace::planeOf<Bare>(end.data())};
    return;
  }
  append(end_stage, HeadParameter::kFocalLength, 8);
  const auto end = seeded<Lensed>(units, scaled, end_stage, kRay);
  lensed = {trace::lensOf<Lensed>(*design.lens, end.data()), trace::planeOf<Lensed>(end.data())};
}

template <typename T>
bool StagedTrace::Stages::finish(const End<T>& end, const Eigen::Matrix<double, kRay, 1>& ray,
                                 Eigen::Vector2d& p_W_mm, Eigen::Matrix<double, 2, T::DIMENSION>& slopes) {
  trace::Ray<T> jets = rayOf<T>(ray);
  trace::Vector2<T> p;
  if (end.lens && !trace::refract<T>(*end.lens, jets)) return false;
  if (!trace::land<T>(end.plane, jets, p)) return false;
  p_W_mm = {p[0].a, p[1].a};
  slopes << p[0].v.transpose(), p[1].v.transpose();
  return true;
}

bool StagedTrace::Stages::landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm,
                                  HeadJacobian& by_scaled) const {
  Eigen::Matrix<double, kRay, 1> ray;
  trace::Ray<First> first = laser;
  if (!trace::reflect<First>(first_mirror, First(angles_rad[first_mirror.motor]), first)) return false;
  Eigen::Matrix<double, kRay, First::DIMENSION> by_first;
  split<First>(first, ray, by_first);
  trace::Ray<Last> last = rayOf<Last>(ray);
  if (!trace::reflect<Last>(last_mirror, Last(angles_rad[last_mirror.motor]), last)) return false;
  Eigen::Matrix<double, kRay, Last::DIMENSION> by_last;
  split<Last>(last, ray, by_last);

  by_scaled.setZero();
  Eigen::Matrix<double, 2, kRay> by_ray;
  const auto end = [&]<typename T>(const End<T>& stage) {
    Eigen::Matrix<double, 2, T::DIMENSION> slopes;
    if (!finish<T>(stage, ray, p_W_mm, slopes)) return false;
    place(slopes.template rightCols<T::DIMENSION - kRay>(), end_stage, by_scaled);
    by_ray = slopes.template leftCols<kRay>();
    return true;
  };
  if (!(bare ? end(*bare) : end(*lensed))) return false;
  const Eigen::Matrix<double, 2, Last::DIMENSION> through_last = by_ray * by_last;
  place(through_last.rightCols<Last::DIMENSION - kRay>(), last_stage, by_scaled);
  const Eigen::Matrix<double, 2, First::DIMENSION> through_first = through_last.leftCols<kRay>() * by_first;
  place(through_first, first_stage, by_scaled);
  return true;
}

StagedTrace::StagedTrace(const HeadDesign& design, const HeadVector& units, const double* scaled)
    : stages_(std::make_unique<const Stages>(design, units, scaled)) {}

StagedTrace::~StagedTrace() = default;

bool StagedTrace::landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm,
                          HeadJacobian& by_scaled) const {
  return stages_->landing(angles_rad, p_W_mm, by_scaled);
}

}  // namespace kerfbench::hil
