// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <vector>

namespace kerfbench::planner {

/// Fault of a library, or of a job for it; what() has one line per fault.
class PowerError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One measured characteristic: straight lines between N+1 points, in both directions (Wang, Li, Chen 2010,
/// eq. 5 to 7).
class Curve {
 public:
  struct Point {
    double x{}, y{};
  };
  Curve() = default;
  /// Makes a curve. @throws PowerError unless there are two points or more, finite and strictly rising in x
  /// and in y.
  explicit Curve(std::vector<Point> points);

  /// Value y at x; beyond the ends that of the end.
  [[nodiscard]] double at(double x) const;
  /// Value x at y; nullopt outside least().y … greatest().y.
  [[nodiscard]] std::optional<double> inverse(double y) const;
  [[nodiscard]] const Point& least() const { return points_.front(); }
  [[nodiscard]] const Point& greatest() const { return points_.back(); }
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }

 private:
  std::vector<Point> points_{{0.0, 0.0}, {1.0, 1.0}};
};

}  // namespace kerfbench::planner
