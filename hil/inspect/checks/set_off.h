// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

namespace kerfbench::inspect::checks {

/// Stretch of the way from where a beam rested within which steps and servo hide how it sets off.
inline constexpr double kNearest_mm = 0.04;

/// Place of the spot in one frame.
struct Place {
  double t_s{};     ///< Since the gate opened.
  double way_mm{};  ///< From the nominal start of the line; < 0 before it.
  double sigma_mm{};
};

/// How a beam sets off from rest. Each law has a function of the way that is a straight line in time and
/// meets zero at the instant t0 at which the beam sets off.
class SetOff {
 public:
  /// s ~ (t - t0)^power. 2: it speeds up evenly; 1: at once with its full speed, as a firmware without ramps
  /// moves mirrors; 3: with limited jerk.
  static SetOff byPower(double power) { return {power, std::numeric_limits<double>::infinity()}; }
  /// Even acceleration over a way of ramp_mm, > 0; from there on the speed is kept.
  static SetOff rampOver(double ramp_mm) { return {2.0, ramp_mm}; }

  /// Function of the way that is straight in time, in any unit of time, 0 at 0; wayAt() is its inverse.
  [[nodiscard]] double timeAt(double way_mm) const;
  [[nodiscard]] double wayAt(double time) const;
  /// Derivative of wayAt() at a place, by place: for way_mm > 0.
  [[nodiscard]] double speedAt(double way_mm) const;

 private:
  SetOff(double power, double ramp_mm) : power_(power), ramp_mm_(ramp_mm) {}
  double power_;
  double ramp_mm_;
};

struct SetOffFit {
  double t0_s{};  ///< When the beam set off, since the gate opened; < 0: the gate is late.
  double sigma_s{};
  double chi_square{std::numeric_limits<double>::infinity()};
  double gate_way_mm{};  ///< From where the beam rested to where it was when the gate opened.
};

/// Weighted least squares over the places beyond kNearest_mm from where the beam rested; those before must
/// fit in as well. `rest_mm`: that place, from the nominal start of the line. chi_square is infinite where no
/// motion away from it fits.
SetOffFit fitSetOff(const std::vector<Place>& places, const SetOff& law, double rest_mm);

/// A chi square smaller by this justifies one more parameter; by chance one start in forty has it.
inline constexpr double kClearlyBetter = 6.0;

/// A ramp that ends within what was seen.
struct RampFit {
  double ramp_mm{};
  SetOffFit fit;  ///< sigma_s: also by the length of the ramp.
};
RampFit fitRamp(const std::vector<Place>& places, double rest_mm);

/// Whether a beam that speeds up evenly, over whatever way, explains the places not clearly worse than
/// `at_once`, a beam that sets off at full speed after the gate opened, and sets off in less than half of
/// that time.
bool rampExplains(const std::vector<Place>& places, double rest_mm, const SetOffFit& at_once);

}  // namespace kerfbench::inspect::checks
