// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::vision {

/// Half of the middle of a kerf from which a caliper takes the peak brightness, px.
inline constexpr double kPeakPx = 0.55;
/// Blur that the spline through the samples of a profile adds: standard deviation, px.
inline constexpr double kSplinePx = 0.7071;

}  // namespace kerfbench::vision
