// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

/// Point and its first two derivatives by u.
struct Jet {
  Eigen::Vector2d p;
  Eigen::Vector2d d1;
  Eigen::Vector2d d2;
};
Jet jetAt(const Curve& curve, double u);

/// A length of the curve's order of magnitude, to scale tolerances: chords of its defining points.
double extentOf(const Curve& curve);

/// The box of one curve, exact to 1e-8 mm.
Eigen::AlignedBox2d boundsOf(const Curve& curve);

}  // namespace kerfbench::dieline
