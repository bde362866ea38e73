// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "hil/dieline/curve_math.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

Vector2d unit(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }
double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

using Homogeneous = Eigen::Matrix<double, 3, 4>;

Homogeneous homogeneous(const BezierCurve& bezier) {
  Homogeneous h;
  for (int i = 0; i < 4; ++i) h.col(i) << bezier.weight(i) * bezier.control_mm.col(i), bezier.weight(i);
  return h;
}

Jet jetOf(const BezierCurve& bezier, double u) {
  const Homogeneous h = homogeneous(bezier);
  const double v = 1.0 - u;
  const Eigen::Vector3d n =
      v * v * v * h.col(0) + 3 * v * v * u * h.col(1) + 3 * v * u * u * h.col(2) + u * u * u * h.col(3);
  const Eigen::Vector3d n1 =
      3 * (v * v * (h.col(1) - h.col(0)) + 2 * v * u * (h.col(2) - h.col(1)) + u * u * (h.col(3) - h.col(2)));
  const Eigen::Vector3d n2 =
      6 * (v * (h.col(2) - 2 * h.col(1) + h.col(0)) + u * (h.col(3) - 2 * h.col(2) + h.col(1)));
  Jet jet;
  jet.p = n.head<2>() / n.z();
  jet.d1 = (n1.head<2>() - jet.p * n1.z()) / n.z();
  jet.d2 = (n2.head<2>() - 2 * jet.d1 * n1.z() - jet.p * n2.z()) / n.z();
  return jet;
}

/// The largest coordinate along `axis`, by halving: the control polygon bounds each half from above.
void raiseMaximum(const Homogeneous& h, int axis, double sign, int depth, double& best) {
  const auto value = [&](int i) { return sign * h(axis, i) / h(2, i); };
  best = std::max({best, value(0), value(3)});
  // Numbers that are none are above nothing: they would be halved without end.
  if (depth == 0 || !(value(1) > best + 1e-9 || value(2) > best + 1e-9)) return;
  Homogeneous left;
  Homogeneous right;
  const Eigen::Vector3d ab = (h.col(0) + h.col(1)) / 2;
  const Eigen::Vector3d bc = (h.col(1) + h.col(2)) / 2;
  const Eigen::Vector3d cd = (h.col(2) + h.col(3)) / 2;
  const Eigen::Vector3d abc = (ab + bc) / 2;
  const Eigen::Vector3d bcd = (bc + cd) / 2;
  left << h.col(0), ab, abc, (abc + bcd) / 2;
  right << (abc + bcd) / 2, bcd, cd, h.col(3);
  raiseMaximum(left, axis, sign, depth - 1, best);
  raiseMaximum(right, axis, sign, depth - 1, best);
}

/// True when t + 2 pi k lies between start and start + sweep for some k.
bool sweeps(double start_rad, double sweep_rad, double t_rad) {
  double ahead = std::fmod(sweep_rad > 0 ? t_rad - start_rad : start_rad - t_rad, 2 * pi);
  if (ahead < 0) ahead += 2 * pi;
  return ahead <= std::abs(sweep_rad);
}

}  // namespace

Jet jetAt(const Curve& curve, double u) {
  return std::visit(Overloaded{[&](const LineCurve& c) {
                                 // Two forms of one line, so that both ends are hit exactly.
                                 const Vector2d d = c.end_mm - c.start_mm;
                                 return Jet{(1 - u) * c.start_mm + u * c.end_mm, d, Vector2d::Zero()};
                               },
                               [&](const ArcCurve& c) {
                                 const Vector2d r = c.radius_mm * unit(c.start_angle_rad + u * c.sweep_rad);
                                 return Jet{c.centre_mm + r, c.sweep_rad * Vector2d(-r.y(), r.x()),
                                            -c.sweep_rad * c.sweep_rad * r};
                               },
                               [&](const EllipseCurve& c) {
                                 const Vector2d t = unit(c.start_rad + u * c.sweep_rad);
                                 const Vector2d r = c.major_mm * t.x() + c.minor_mm * t.y();
                                 return Jet{c.centre_mm + r,
                                            c.sweep_rad * (c.minor_mm * t.x() - c.major_mm * t.y()),
                                            -c.sweep_rad * c.sweep_rad * r};
                               },
                               [&](const BezierCurve& c) { return jetOf(c, u); }},
                    curve);
}

double extentOf(const Curve& curve) {
  return std::visit(Overloaded{[](const LineCurve& c) { return (c.end_mm - c.start_mm).norm(); },
                               [](const ArcCurve& c) { return c.radius_mm * std::abs(c.sweep_rad); },
                               [](const EllipseCurve& c) {
                                 return (c.major_mm.norm() + c.minor_mm.norm()) * std::abs(c.sweep_rad);
                               },
                               [](const BezierCurve& c) {
                                 double sum = 0;
                                 for (int i = 0; i < 3; ++i)
                                   sum += (c.control_mm.col(i + 1) - c.control_mm.col(i)).norm();
                                 return sum;
                               }},
                    curve);
}

Vector2d pointAt(const Curve& curve, double u) { return jetAt(curve, u).p; }

Vector2d derivativeAt(const Curve& curve, double u) { return jetAt(curve, u).d1; }

Vector2d tangentAt(const Curve& curve, double u) {
  const double extent = extentOf(curve);
  const Vector2d d = derivativeAt(curve, u);
  if (d.norm() > 1e-9 * extent) return d.normalized();
  // A control point on top of an end: the chord over a short piece has the direction of the limit.
  for (const double h : {1e-5, 1e-3, 1.0}) {
    const Vector2d chord = pointAt(curve, std::min(1.0, u + h)) - pointAt(curve, std::max(0.0, u - h));
    if (chord.norm() > 1e-13 * extent && chord.norm() > 0) return chord.normalized();
  }
  return Vector2d::UnitX();
}

double curvatureAt(const Curve& curve, double u) {
  const Jet jet = jetAt(curve, u);
  const double speed = jet.d1.norm();
  if (speed <= 1e-9 * extentOf(curve)) return 0.0;
  return cross(jet.d1, jet.d2) / (speed * speed * speed);
}

Curve reversed(const Curve& curve) {
  return std::visit(
      Overloaded{
          [](const LineCurve& c) -> Curve {
            return LineCurve{c.end_mm, c.start_mm};
          },
          [](const ArcCurve& c) -> Curve {
            return ArcCurve{c.centre_mm, c.radius_mm, c.start_angle_rad + c.sweep_rad, -c.sweep_rad};
          },
          [](const EllipseCurve& c) -> Curve {
            return EllipseCurve{c.centre_mm, c.major_mm, c.minor_mm, c.start_rad + c.sweep_rad, -c.sweep_rad};
          },
          [](const BezierCurve& c) -> Curve {
            return BezierCurve{c.control_mm.rowwise().reverse(), c.weight.reverse()};
          }},
      curve);
}

Curve transformed(const Curve& curve, const Eigen::Affine2d& X) {
  const Eigen::Matrix2d A = X.linear();
  return std::visit(
      Overloaded{
          [&](const LineCurve& c) -> Curve {
            return LineCurve{X * c.start_mm, X * c.end_mm};
          },
          [&](const ArcCurve& c) -> Curve {
            const double scale_squared = std::abs(A.determinant());
            const Eigen::Matrix2d gram = A.transpose() * A;
            const bool similarity =
                (gram - scale_squared * Eigen::Matrix2d::Identity()).norm() <= 1e-10 * gram.norm();
            if (!similarity || scale_squared == 0) {
              return EllipseCurve{X * c.centre_mm, A.col(0) * c.radius_mm, A.col(1) * c.radius_mm,
                                  c.start_angle_rad, c.sweep_rad};
            }
            const Vector2d start = A * unit(c.start_angle_rad);
            return ArcCurve{X * c.centre_mm, c.radius_mm * std::sqrt(scale_squared),
                            std::atan2(start.y(), start.x()),
                            A.determinant() < 0 ? -c.sweep_rad : c.sweep_rad};
          },
          [&](const EllipseCurve& c) -> Curve {
            return EllipseCurve{X * c.centre_mm, A * c.major_mm, A * c.minor_mm, c.start_rad, c.sweep_rad};
          },
          [&](const BezierCurve& c) -> Curve {
            BezierCurve image = c;
            for (int i = 0; i < 4; ++i) image.control_mm.col(i) = X * Vector2d(c.control_mm.col(i));
            return image;
          }},
      curve);
}

bool isClosed(const Curve& curve) { return (pointAt(curve, 0) - pointAt(curve, 1)).norm() <= 1e-6; }

Eigen::AlignedBox2d boundsOf(const Curve& curve) {
  Eigen::AlignedBox2d box(pointAt(curve, 0));
  box.extend(pointAt(curve, 1));
  std::visit(Overloaded{[](const LineCurve&) {},
                        [&](const ArcCurve& c) {
                          for (int i = 0; i < 4; ++i) {
                            const double t = i * pi / 2;
                            if (sweeps(c.start_angle_rad, c.sweep_rad, t))
                              box.extend(c.centre_mm + c.radius_mm * unit(t));
                          }
                        },
                        [&](const EllipseCurve& c) {
                          for (int axis = 0; axis < 2; ++axis) {
                            const double t = std::atan2(c.minor_mm(axis), c.major_mm(axis));
                            for (const double at : {t, t + pi}) {
                              if (!sweeps(c.start_rad, c.sweep_rad, at)) continue;
                              box.extend(c.centre_mm + c.major_mm * std::cos(at) + c.minor_mm * std::sin(at));
                            }
                          }
                        },
                        [&](const BezierCurve& c) {
                          const Homogeneous h = homogeneous(c);
                          for (int axis = 0; axis < 2; ++axis) {
                            double high = box.max()(axis);
                            double low = -box.min()(axis);
                            raiseMaximum(h, axis, 1.0, 40, high);
                            raiseMaximum(h, axis, -1.0, 40, low);
                            box.max()(axis) = high;
                            box.min()(axis) = -low;
                          }
                        }},
             curve);
  return box;
}

std::shared_ptr<const Dieline> emptyDieline() { return std::make_shared<const Dieline>(); }

std::string_view processName(Process process) {
  switch (process) {
    case Process::kCut:
      return "cut";
    case Process::kHalfCut:
      return "half-cut";
    case Process::kCrease:
      return "crease";
    case Process::kPerforation:
      return "perforation";
    case Process::kIgnore:
      return "ignore";
  }
  return "?";
}

Eigen::AlignedBox2d Dieline::bounds() const {
  Eigen::AlignedBox2d box;
  for (const Entity& entity : entities) {
    if (entity.process != Process::kIgnore) box.extend(boundsOf(entity.curve));
  }
  return box;
}

}  // namespace kerfbench::dieline
