// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace kerfbench::planner
