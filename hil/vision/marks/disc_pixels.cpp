// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/disc_pixels.h"

#include <cmath>
#include <numbers>

#include "twin/base/multiversion.h"
#include "twin/base/wide_math.h"

namespace kerfbench::vision {
namespace {

constexpr std::size_t kLanes = DiscPixels::kLanes;
constexpr double kEdgeSigmaPx = 0.7;
// Noise takes shares a little beyond none and all.
constexpr float kLeastShare = -0.15F;
constexpr float kMostShare = 1.15F;

/// What addEdge() needs pixel by pixel.
struct EdgePixels {
  std::array<float, DiscPixels::kMost> share, beyond;
  std::array<std::int32_t, DiscPixels::kMost> sector;
};

/// Pixels behind the last one count nought.
float counts(std::size_t i, std::size_t count) { return i < count ? 1.0F : 0.0F; }

KERFBENCH_WIDE void weigh(const DiscPixels& pixels, const DiscEdge& edge, EdgePixels& out, EdgeSums& sums) {
  for (std::size_t first = 0; first < pixels.count; first += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = first + lane;
      const float light = 1.0F + edge.slope_x * pixels.x[i] + edge.slope_y * pixels.y[i];
      const float dark = edge.board - edge.per_gray * pixels.gray[i] / light;
      const float least = dark > kLeastShare ? dark : kLeastShare;
      const float share = least < kMostShare ? least : kMostShare;
      out.share[i] = share;
      const float ink = i < pixels.count ? share : 0.0F;
      sums.ink[lane] += ink;
      sums.x[lane] += ink * pixels.x[i];
      sums.y[lane] += ink * pixels.y[i];
    }
  }
}

KERFBENCH_WIDE void compareWithRound(const DiscPixels& pixels, const DiscEdge& edge, EdgePixels& out,
                                     EdgeSums& sums) {
  static_assert(kSectors == 12);
  constexpr float kTan30 = std::numbers::inv_sqrt3_v<float>;
  constexpr float kTan60 = std::numbers::sqrt3_v<float>;
  constexpr auto kPerPx = static_cast<float>(1.0 / (kEdgeSigmaPx * std::numbers::sqrt2));
  const float xx = edge.circle(0, 0);
  const float xy = edge.circle(0, 1);
  const float yx = edge.circle(1, 0);
  const float yy = edge.circle(1, 1);
  for (std::size_t i = 0; i < pixels.count; ++i) {
    const float right = xx * pixels.x[i] + xy * pixels.y[i];
    const float down = yx * pixels.x[i] + yy * pixels.y[i];
    const float outside = std::sqrt(right * right + down * down) - edge.radius_px;
    out.beyond[i] = out.share[i] - 0.5F * wideErfc(kPerPx * outside);
    const float a = right < 0.0F ? -right : right;
    const float b = down < 0.0F ? -down : down;
    const std::int32_t third = (b >= kTan30 * a ? 1 : 0) + (b >= kTan60 * a ? 1 : 0);
    const std::int32_t above = right < 0.0F ? third : 5 - third;
    const std::int32_t below = right < 0.0F ? 11 - third : 6 + third;
    out.sector[i] = down < 0.0F ? above : below;
  }
  for (std::size_t first = 0; first < pixels.count; first += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = first + lane;
      const float square = pixels.x[i] * pixels.x[i] + pixels.y[i] * pixels.y[i];
      const float half_square = 0.5F * counts(i, pixels.count) * square;
      const float even_gray = (edge.board - out.share[i]) / edge.per_gray;
      sums.half_square[lane] += half_square;
      sums.half_square_gray[lane] += half_square * even_gray;
    }
  }
}

KERFBENCH_WIDE void addToMoments(const DiscPixels& pixels, const GrayRange& range, GrayMoments& sums) {
  for (std::size_t first = 0; first < pixels.count; first += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = first + lane;
      const float light = 1.0F + range.slope_x * pixels.x[i] + range.slope_y * pixels.y[i];
      const float is = counts(i, pixels.count);
      const float is_below = pixels.gray[i] < range.least * light ? is : 0.0F;
      const float is_above = pixels.gray[i] > range.most * light ? is : 0.0F;
      const double n = is - is_below - is_above;
      const double x = n * pixels.x[i];
      const double y = n * pixels.y[i];
      const double gray = n * pixels.gray[i];
      sums.below[lane] += is_below;
      sums.above[lane] += is_above;
      sums.n[lane] += n;
      sums.x[lane] += x;
      sums.y[lane] += y;
      sums.gray[lane] += gray;
      sums.xx[lane] += x * x;
      sums.xy[lane] += x * y;
      sums.yy[lane] += y * y;
      sums.x_gray[lane] += x * gray;
      sums.y_gray[lane] += y * gray;
      sums.gray2[lane] += gray * gray;
    }
  }
}

}  // namespace

void addMoments(const DiscPixels& pixels, const GrayRange& range, GrayMoments& sums) {
  addToMoments(pixels, range, sums);
}

void addEdge(const DiscPixels& pixels, const DiscEdge& edge, bool compare, EdgeSums& sums) {
  EdgePixels each;
  weigh(pixels, edge, each, sums);
  if (!compare) return;
  compareWithRound(pixels, edge, each, sums);
  for (std::size_t i = 0; i < pixels.count; ++i)
    sums.beyond[static_cast<std::size_t>(each.sector[i])] += each.beyond[i];
}

}  // namespace kerfbench::vision
