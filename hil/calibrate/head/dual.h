// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Core>

namespace kerfbench::calibrate {

/// A number and its derivatives by N variables: forward automatic differentiation. A function written for a
/// type T and called with Dual<N> gives its value and its exact derivatives at once.
///
///     f(a + h) = f(a) + f'(a) h
template <int N>
struct Dual {
  using Slopes = Eigen::Matrix<double, N, 1>;

  double value{};
  Slopes slopes{Slopes::Zero()};

  Dual() = default;
  explicit Dual(double constant) : value(constant) {}
  /// Variable `k` of the N.
  Dual(double at, int k) : value(at) { slopes[k] = 1.0; }
  template <typename Derived>
  Dual(double at, const Eigen::MatrixBase<Derived>& by) : value(at), slopes(by) {}

  Dual& operator+=(const Dual& other) { return *this = *this + other; }
  Dual& operator-=(const Dual& other) { return *this = *this - other; }
  Dual& operator*=(const Dual& other) { return *this = *this * other; }
  Dual& operator/=(const Dual& other) { return *this = *this / other; }

  friend Dual operator-(const Dual& f) { return {-f.value, -f.slopes}; }
  friend Dual operator+(const Dual& f, const Dual& g) { return {f.value + g.value, f.slopes + g.slopes}; }
  friend Dual operator+(const Dual& f, double s) { return {f.value + s, f.slopes}; }
  friend Dual operator+(double s, const Dual& f) { return {f.value + s, f.slopes}; }
  friend Dual operator-(const Dual& f, const Dual& g) { return {f.value - g.value, f.slopes - g.slopes}; }
  friend Dual operator-(const Dual& f, double s) { return {f.value - s, f.slopes}; }
  friend Dual operator-(double s, const Dual& f) { return {s - f.value, -f.slopes}; }
  friend Dual operator*(const Dual& f, const Dual& g) {
    return {f.value * g.value, f.value * g.slopes + f.slopes * g.value};
  }
  friend Dual operator*(const Dual& f, double s) { return {f.value * s, f.slopes * s}; }
  friend Dual operator*(double s, const Dual& f) { return {f.value * s, f.slopes * s}; }
  friend Dual operator/(const Dual& f, const Dual& g) {
    const double inverse = 1.0 / g.value;
    const double quotient = f.value * inverse;
    return {quotient, (f.slopes - quotient * g.slopes) * inverse};
  }
  friend Dual operator/(double s, const Dual& g) {
    return {s / g.value, g.slopes * (-s / (g.value * g.value))};
  }
  friend Dual operator/(const Dual& f, double s) {
    const double inverse = 1.0 / s;
    return {f.value * inverse, f.slopes * inverse};
  }

  friend bool operator<(const Dual& f, const Dual& g) { return f.value < g.value; }
  friend bool operator<(const Dual& f, double s) { return f.value < s; }
  friend bool operator>(const Dual& f, const Dual& g) { return f.value > g.value; }
  friend bool operator>(const Dual& f, double s) { return f.value > s; }

  friend Dual sqrt(const Dual& f) {
    const double root = std::sqrt(f.value);
    return {root, f.slopes * (1.0 / (2.0 * root))};
  }
  friend Dual sin(const Dual& f) { return {std::sin(f.value), std::cos(f.value) * f.slopes}; }
  friend Dual cos(const Dual& f) { return {std::cos(f.value), -std::sin(f.value) * f.slopes}; }
  friend Dual asin(const Dual& f) {
    return {std::asin(f.value), 1.0 / std::sqrt(1.0 - f.value * f.value) * f.slopes};
  }
};

}  // namespace kerfbench::calibrate

/// Makes Eigen's matrices take it as a scalar.
template <int N>
struct Eigen::NumTraits<kerfbench::calibrate::Dual<N>> {
  using Real = kerfbench::calibrate::Dual<N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 3,
    RequireInitialization = 1
  };
  static Real dummy_precision() { return Real(1e-12); }
  static Real epsilon() { return Real(std::numeric_limits<double>::epsilon()); }
  static Real highest() { return Real(std::numeric_limits<double>::max()); }
  static Real lowest() { return Real(std::numeric_limits<double>::lowest()); }
  static int digits10() { return std::numeric_limits<double>::digits10; }
};

template <typename BinaryOp, int N>
struct Eigen::ScalarBinaryOpTraits<kerfbench::calibrate::Dual<N>, double, BinaryOp> {
  using ReturnType = kerfbench::calibrate::Dual<N>;
};
template <typename BinaryOp, int N>
struct Eigen::ScalarBinaryOpTraits<double, kerfbench::calibrate::Dual<N>, BinaryOp> {
  using ReturnType = kerfbench::calibrate::Dual<N>;
};
