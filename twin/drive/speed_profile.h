// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kerfbench::twin {

/// Speed of a line at a time.
struct SpeedPoint {
  double time_s{};
  double speed_mm_s{};
};

/// Speed of a line over time: constant up to t = 0, linear from point to point, constant after the last.
class SpeedProfile {
 public:
  /// Makes a profile. @throws std::invalid_argument unless all times are > 0 and ascend, and all values are
  /// finite.
  explicit SpeedProfile(double start_speed_mm_s, const std::vector<SpeedPoint>& changes = {});

  [[nodiscard]] double speed_mm_s(double time_s) const;
  /// Travel since t = 0, the exact integral of the speed; negative before.
  [[nodiscard]] double travel_mm(double time_s) const;

 private:
  struct Knot {
    SpeedPoint at;
    double travel_mm{};
  };
  [[nodiscard]] const Knot& knotBefore(double time_s) const;
  [[nodiscard]] double acceleration_mm_s2(const Knot& from) const;

  std::vector<Knot> knots_;  ///< Knots of the profile; the first is t = 0.
};

}  // namespace kerfbench::twin
