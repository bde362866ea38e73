// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/parameter_names.h"
#include "firmware_under_test/planner/power/library.h"

namespace kerfbench::planner {

struct PowerWish {
  double spot_diameter_mm{0.2};  ///< Spot diameter d; 0.2 … 0.5 in the paper, 0.01 … 10 here.
  double depth_mm{};             ///< Depth of cuts, Z1; >= 1e-4, no more than the material's greatest.
  /// Depth of creases and half-cuts; > 0, < depth_mm. None: Z times depth_mm.
  std::optional<double> half_depth_mm{};
  /// Whose names faults use; those of a scenario are told at its keys, in plain words.
  GivenBy given_by{GivenBy::kScenario};
  /// Materials of the library in which the depth can be had, for the fault that it cannot; empty: none is
  /// known.
  std::string deeper_materials{};
};

/// The chain of Wang, Li, Chen 2010: depth D → P_ua = f⁻¹(D) → P_out = P_ua F d → u = g⁻¹(P_out), within what
/// the laser can do. Immutable, so safe to share between threads.
class PowerModel {
 public:
  /// Makes the model. @throws PowerError that names everything that is impossible, and what is possible.
  PowerModel(Material material, LaserTube laser, const PowerWish& wish);

  enum class Limit { kNone, kLeast, kMost };
  /// Setting of the laser at one speed.
  struct Setting {
    double p_ua_j_mm2{};        ///< P_ua for the wanted depth.
    double wanted_w{};          ///< Wanted power P_out.
    double power_w{};           ///< Power within the laser's limits.
    double control{};           ///< Control signal u, in the laser's unit.
    Limit limit{Limit::kNone};  ///< Limit that the power is held at.
    double depth_mm{};          ///< Depth reached by power_w.
  };
  /// Setting at a speed F > 0 and a depth. @throws std::domain_error.
  [[nodiscard]] Setting at(double speed_mm_s, double depth_mm) const;

  /// Speeds between which the wanted depth is possible.
  struct Speeds {
    double lowest_mm_s{}, highest_mm_s{};
  };
  [[nodiscard]] Speeds speedsFor(double depth_mm) const;

  /// PWM byte nearest to u, never beyond the laser's limits.
  [[nodiscard]] std::uint8_t byteFor(double control) const;
  /// Power of a PWM byte: g.
  [[nodiscard]] double powerOf(std::uint8_t byte) const;
  /// Depth of a power at a speed: f.
  [[nodiscard]] double depthBy(double power_w, double speed_mm_s) const;
  /// Depth for Z: 1 the cut's, half_z the half-cut's if one is given, else Z times the cut's.
  [[nodiscard]] double depthOf(double z, double half_z) const;

  [[nodiscard]] const Material& material() const { return material_; }
  [[nodiscard]] const LaserTube& laser() const { return laser_; }
  [[nodiscard]] const PowerWish& wish() const { return wish_; }

 private:
  Material material_;
  LaserTube laser_;
  PowerWish wish_;
  int least_byte_{}, most_byte_{};
};

/// Table with rows of speed, P_ua, P_out, u, PWM byte and the depth that this byte cuts, and the range of
/// speeds at which the depth is possible.
std::string powerTable(const PowerModel& model, double depth_mm, const std::vector<double>& speeds_mm_s);
/// Speeds 1, 2, 5, 10 … mm/s, from just below to just above the range at which a depth is possible, and its
/// ends.
std::vector<double> tableSpeeds(const PowerModel& model, double depth_mm);

}  // namespace kerfbench::planner
