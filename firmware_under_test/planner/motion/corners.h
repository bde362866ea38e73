// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::planner {

/// What the beam may miss of a corner so that it need not stop there.
struct CornerLimits {
  /// Largest distance of the beam from the corner as drawn, mm; 0: not stated, and no corner is rounded.
  double error_mm{0.0};
  /// Delay of the drives behind their pulses, s; >= 0.
  double lag_s{0.0};
};

/// Highest speed, mm/s, at which a path may turn by turn_rad (0 … pi) at one point, with braking before it
/// and speeding up after it. Falls steadily with the turn, from no limit to a stop: there is no angle from
/// which on a joint is a corner. With s = 2 sin(turn/2), the change of direction, the speed v keeps
///
///     (v/T + a/2) s <= a
///     v s (0.27 tau + T/4) + s a tau²/8 <= error
///
/// The first is the second difference of places one period T apart, if the corner is one of them; it is up to
/// 2.6 % more where the corner lies between two. The second
/// is the way by which the beam cuts the corner off: up to v s T/4 by the chord of the period in which the
/// corner lies, and the lag of the drives. A change dv of the velocity leaves a critically damped drive whose
/// delay is tau behind by 2 e^-2 dv tau = 0.27 dv tau (half of the mean deviation of its response from tau);
/// braking and speeding up by a on either side leaves s a tau²/8 (half of half the variance tau²/2).
double turnSpeed(double turn_rad, double acceleration_mm_s2, double period_s, const CornerLimits& corners);

}  // namespace kerfbench::planner
