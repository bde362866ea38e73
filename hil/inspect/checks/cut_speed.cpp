// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/inspect/checks/spot_checks.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr double kBase_s = 2e-3;  ///< Over which a speed is read, or one frame if those are rarer.

}  // namespace

void measureTopSpeed(const LitFrames& lit, const LitRun& run, CutResult& cut) {
  cut.top_speed_mm_s = cut.top_speed_U_mm_s = std::numeric_limits<double>::quiet_NaN();
  std::size_t from = run.begin;
  for (std::size_t to = run.begin + 1; to < run.end; ++to) {
    while (from + 1 < to && lit.frames[to].time_s - lit.frames[from + 1].time_s >= kBase_s) ++from;
    const LitFrame& a = lit.frames[from];
    const LitFrame& b = lit.frames[to];
    const double base_s = b.time_s - a.time_s;
    if (a.unit != b.unit || base_s < std::min(kBase_s, lit.period_s) * 0.999) continue;
    const double speed_mm_s = (b.p_S_mm - a.p_S_mm).norm() / base_s;
    if (speed_mm_s <= cut.top_speed_mm_s) continue;  // false against NaN
    cut.top_speed_mm_s = speed_mm_s;
    cut.top_speed_U_mm_s = 2.0 * std::hypot(a.sigma_mm, b.sigma_mm) / base_s;
  }
}

}  // namespace kerfbench::inspect::checks
