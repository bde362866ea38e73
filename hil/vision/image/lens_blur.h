// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::vision {

/// Standard deviation of a picture's blur, px, by lens and pixel together, and its standard uncertainty.
struct LensBlur {
  double px{};
  double sigma_px{};
};

/// Usual blur, for pictures without printed marks (see blurOf()): a lens that resolves its sensor blurs by
/// 0.5 … 0.9 px.
inline constexpr LensBlur kUsualBlur{0.7, 0.1};

}  // namespace kerfbench::vision
