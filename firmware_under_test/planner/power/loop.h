// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kerfbench::planner {

struct PowerLimits {
  double least_w{}, most_w{};  ///< Limits of the power; 0 <= least < most.
};

/// Power of the next period (Wang, Li, Chen 2010, figure 3): P(k+1) = P(k) + gain (P_out - P_f); u = g⁻¹(P).
/// The specification of the firmware's loop.
///
/// `wanted_w` (P_out) is brought within the limits first, and so is the result, which is all the loop
/// remembers: there is no sum that could wind up. The first period of a mark commands P_out itself. A
/// measurement that is negative or none runs the period open: P_out.
///
/// With the paper's gain of 1 the error of a tube with G times its nominal power shrinks by |1 - G| in each
/// period: settled within ±20 % of 1, unstable from 2 on. That holds for P_f of the same period as P(k). If
/// it comes a period late, or the tube takes a good part of a period to answer, gain 1 rings without end;
/// gain 0.4 then settles. The firmware's own loop is controller/core/power_loop.h, which learns in shares of
/// P_out.
/// @param gain in (0, 1].
double nextPower(double power_w, double wanted_w, double measured_w, const PowerLimits& limits,
                 double gain = 1.0);

/// Gain that settles without ringing where a measurement is this many periods late: 0.4 of that at which the
/// loop would ring for ever, which for an integrator behind a delay of n periods is 2 sin(pi / (2 (2 n +
/// 1))).
double dampedGain(int late_periods);

/// How a loop learns: in watts, as the paper writes it, or in shares of P_out, as the firmware does.
enum class LoopLaw { kWatts, kShares };

/// Course of a loop: the tube's power in each period over the wanted one, for a tube with `tube` times its
/// nominal power whose measurement comes late_periods periods after the period that it measures, 0: before
/// the next is commanded. P_out is that of the measured period, and what it changes by is commanded at once.
/// @pre wanted powers > 0, late_periods >= 0.
std::vector<double> loopCourse(const std::vector<double>& wanted_w, double tube, int late_periods,
                               double gain, LoopLaw law, const PowerLimits& limits);

}  // namespace kerfbench::planner
