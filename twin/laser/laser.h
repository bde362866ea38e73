// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "twin/laser/power_noise.h"

namespace kerfbench::twin {

/// A point of a tube's characteristic (S3: P_out = g(u), piecewise linear).
struct PowerPoint {
  double demand{};  ///< u, 0…1.
  double share{};   ///< Share of full power, 0…1.
};

struct LaserDescription {
  double full_power_w{100.0};  ///< Power at demand 1; > 0.
  double rise_time_s{20e-6};   ///< Time constant of the tube's first-order response upwards; >= 0.
  double fall_time_s{20e-6};   ///< Time constant of the tube's first-order response downwards; >= 0.
  /// Delay from the pins to the tube's demand; >= 0. Applied by the reader of the pins, as the levels below.
  double gate_delay_s{0.0};
  /// Characteristic g: ascending in both, from (0, 0) to (1, 1). Empty: the straight line. The demand that it
  /// maps is the mean over `demand_filter_s`: a tube follows the duty of its PWM, not each pulse. Below a
  /// tube's threshold the share may stay at 0, so shares need not ascend strictly.
  std::vector<PowerPoint> power_curve{};
  double demand_filter_s{0.0};       ///< Time constant of the supply's PWM filter; >= 0.
  double noise{};                    ///< Relative standard deviation of the power; 0 … 0.3.
  double noise_correlation_s{1e-3};  ///< Correlation time of the noise; 1e-5 … 1e4.
  double drift{};                    ///< Relative change of power by warming up, in the end; > -1.
  double drift_time_s{600.0};        ///< Time constant of warming up; > 0.
  bool gate_low{};  ///< The laser may emit while the pin of its gate is low, else while high.
  bool pwm_low{};   ///< The demand is the share of low at the pin of the PWM, else of high.
};

/// Everything that is wrong with a laser, in one line; empty when nothing is.
std::string faultsOf(const LaserDescription& laser);

/// A CO2 tube and its supply: gate and PWM in, power out.
///
/// The supply smooths the PWM (first order, demand_filter_s); the gate enables the tube and is not smoothed:
/// it blanks at once. The tube goes towards gate * g(smoothed duty) * full power, first order, with one time
/// constant upwards and another downwards. Noise (Ornstein-Uhlenbeck) and warming up, 1 - exp(-t/T) of the
/// drift, scale the power.
///
/// Deterministic: the noise is a function of seed and time, so how the time is cut into steps changes nothing
/// but the mean over each step that gate, duty and smoothed duty are given by.
class Laser {
 public:
  /// Makes a tube. @throws std::invalid_argument that names every value out of range.
  explicit Laser(const LaserDescription& description, std::uint64_t seed);

  /// Runs the tube in [begin_s, begin_s + step_s]; steps follow one another. Returns the energy emitted in
  /// it, J: the exact integral for a gate and a duty that are constant over the step.
  /// @param gate  share of the step in which the gate was open, 0…1.
  /// @param duty  mean of the PWM, 0…1: while the gate was open, or over the whole step if it was shut.
  double step(double gate, double duty, double begin_s, double step_s);
  /// Runs a tube without a gate of its own: `demand` is the duty, and the gate is open.
  double step(double demand, double begin_s, double step_s) { return step(1.0, demand, begin_s, step_s); }
  /// True if a step with a shut gate emits nothing and leaves the tube as it is, so that it need not be made.
  [[nodiscard]] bool dark() const { return steady_w_ == 0.0 && description_.demand_filter_s == 0.0; }
  [[nodiscard]] double power_w() const { return power_w_; }  ///< Power at the end of the last step.

 private:
  /// Factors that follow from the last step's length and the time constants.
  struct Decay {
    double step_s{-1.0};
    double rise{}, fall{}, filter{};  ///< Factors exp(-step / time constant).
    double filter_mean{};             ///< Remainder of the filter's lag on the mean over the step.
  };

  /// Warming up between two points of a fixed grid of times: a straight line, 2e-6 of the drift off.
  struct Warmth {
    double begin_s{0.0}, end_s{-1.0};
    double at_begin{}, slope_1_s{};
  };

  [[nodiscard]] double curve(double demand) const;
  double warmth(double time_s);
  double smoothed(double duty);
  void setLength(double step_s);

  LaserDescription description_;
  PowerNoise noise_;
  Decay decay_;
  Warmth warmth_;
  double smoothed_{0.0};  ///< Duty behind the supply's filter.
  double steady_w_{0.0};  ///< Power without noise and drift, at the end of the last step.
  double power_w_{0.0};
};

}  // namespace kerfbench::twin
