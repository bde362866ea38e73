// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerfbench::planner {

/// Speed v_x of a strip over time, S0's v_x(t): linear between knots, constant before the first and after the
/// last.
class StripFeed {
 public:
  struct Knot {
    double time_s{}, speed_mm_s{};
  };

  /// Even speed, > 0.
  explicit StripFeed(double speed_mm_s) : StripFeed(std::vector<Knot>{{0.0, speed_mm_s}}) {}
  /// At least one knot; times rise strictly, speeds are > 0. @throws PlanError that names all faults.
  explicit StripFeed(std::vector<Knot> knots);
  /// Reads "0:200,1.8:200,2:202.2", seconds and mm/s. @throws PlanError.
  static StripFeed parse(const std::string& text);

  [[nodiscard]] double speedMm_s(double time_s) const;
  /// Strip that passes from time 0 on: the integral of the speed; time_s >= 0.
  [[nodiscard]] double travelMm(double time_s) const;
  /// Time at which this much has passed; travel_mm >= 0.
  [[nodiscard]] double timeS(double travel_mm) const;
  /// Mean speed over a span: the speed v_x(t0) that the mean value theorem gives.
  [[nodiscard]] double meanMm_s(double from_s, double to_s) const {
    return (travelMm(to_s) - travelMm(from_s)) / (to_s - from_s);
  }
  [[nodiscard]] double lowestMm_s() const;
  [[nodiscard]] double highestMm_s() const;

 private:
  std::vector<Knot> knots_;
};

}  // namespace kerfbench::planner
