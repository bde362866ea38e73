// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/staged_trace.h"

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

StagedTrace::StagedTrace(const HeadDesign& design, const HeadVector& units, const double* scaled) {
  const trace::Drawing drawing = trace::drawingOf(design);
  append(first_, HeadParameter::kThrow, 2);
  append(first_, trace::firstOfMirror(drawing.motors[0]), 6);
  append(first_, HeadParameter::kBeamOffsetA, 4);
  append(last_, HeadParameter::kThrow, 1);
  append(last_, trace::firstOfMirror(drawing.motors[1]), 6);
  append(end_, HeadParameter::kPlaneHeight, 6);
  const auto first = seeded<First>(units, scaled, first_, 0);
  laser_ = trace::laserOf<First>(design, first.data());
  first_mirror_ = trace::mirrorOf<First>(design, 0, first.data());
  last_mirror_ = trace::mirrorOf<Last>(design, 1, seeded<Last>(units, scaled, last_, kRay).data());
  if (!design.lens) {
    const auto end = seeded<Bare>(units, scaled, end_, kRay);
    bare_ = {std::nullopt, trace::planeOf<Bare>(end.data())};
    return;
  }
  append(end_, HeadParameter::kFocalLength, 8);
  const auto end = seeded<Lensed>(units, scaled, end_, kRay);
  lensed_ = {trace::lensOf<Lensed>(*design.lens, end.data()), trace::planeOf<Lensed>(end.data())};
}

template <typename T>
bool StagedTrace::finish(const End<T>& end, const Eigen::Matrix<double, kRay, 1>& ray,
                         Eigen::Vector2d& p_W_mm, Eigen::Matrix<double, 2, T::DIMENSION>& slopes) {
  trace::Ray<T> jets = rayOf<T>(ray);
  trace::Vector2<T> p;
  if (end.lens && !trace::refract<T>(*end.lens, jets)) return false;
  if (!trace::land<T>(end.plane, jets, p)) return false;
  p_W_mm = {p[0].a, p[1].a};
  slopes << p[0].v.transpose(), p[1].v.transpose();
  return true;
}

bool StagedTrace::landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm,
                          HeadJacobian& by_scaled) const {
  Eigen::Matrix<double, kRay, 1> ray;
  trace::Ray<First> first = laser_;
  if (!trace::reflect<First>(first_mirror_, First(angles_rad[first_mirror_.motor]), first)) return false;
  Eigen::Matrix<double, kRay, First::DIMENSION> by_first;
  split<First>(first, ray, by_first);
  trace::Ray<Last> last = rayOf<Last>(ray);
  if (!trace::reflect<Last>(last_mirror_, Last(angles_rad[last_mirror_.motor]), last)) return false;
  Eigen::Matrix<double, kRay, Last::DIMENSION> by_last;
  split<Last>(last, ray, by_last);

  by_scaled.setZero();
  Eigen::Matrix<double, 2, kRay> by_ray;
  const auto end = [&]<typename T>(const End<T>& stage) {
    Eigen::Matrix<double, 2, T::DIMENSION> slopes;
    if (!finish<T>(stage, ray, p_W_mm, slopes)) return false;
    place(slopes.template rightCols<T::DIMENSION - kRay>(), end_, by_scaled);
    by_ray = slopes.template leftCols<kRay>();
    return true;
  };
  if (!(bare_ ? end(*bare_) : end(*lensed_))) return false;
  const Eigen::Matrix<double, 2, Last::DIMENSION> through_last = by_ray * by_last;
  place(through_last.rightCols<Last::DIMENSION - kRay>(), last_, by_scaled);
  const Eigen::Matrix<double, 2, First::DIMENSION> through_first = through_last.leftCols<kRay>() * by_first;
  place(through_first, first_, by_scaled);
  return true;
}

}  // namespace kerfbench::hil
