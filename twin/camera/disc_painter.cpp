// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/disc_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "twin/base/multiversion.h"
#include "twin/base/wide_math.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr float kInkSigmas = 4.0F;  ///< Farther from its edge a disc is all ink, or has none.

/// Region where the edge of a disc passes at any of its places: nearer to their middle all places cover,
/// further off none does.
struct RingOfEdges {
  RingOfEdges(const MarkImage& mark, const Vector2d& middle_mm, double reach_mm) {
    double spread_mm = 0.0;
    for (const Vector2d& place_mm : mark.p_WM_mm)
      spread_mm = std::max(spread_mm, (place_mm - middle_mm).norm());
    inner_mm = mark.radius_mm - reach_mm - spread_mm;
    outer_mm = mark.radius_mm + reach_mm + spread_mm;
  }

  double inner_mm{};  ///< May be below nought: then no pixel is all ink.
  double outer_mm{};
};

/// A row of pixels on the plane, from the disc's middle: pixel x of its box lies at c0 + s (c1 + s c2), s =
/// (x
/// - x0) / width.
class RowOnPlane {
 public:
  RowOnPlane(const PlanePatch& patch, const PixelBox& box, int y, const Vector2d& middle_mm)
      : x0_(box.x0), width_(box.x1 - box.x0) {
    const double t = (y - box.y0) / static_cast<double>(box.y1 - box.y0);
    const Vector2d c0 = patch.alongRow(t, 0) - middle_mm;
    const Vector2d c1 = patch.alongRow(t, 1);
    const Vector2d c2 = patch.alongRow(t, 2);
    c0_ = c0.cast<float>();
    c1_ = c1.cast<float>();
    c2_ = c2.cast<float>();
    const Vector2d chord = c1 + c2;
    per_square_ = 1.0 / chord.squaredNorm();
    const double along = c0.dot(chord);
    middle_px_ = x0_ - along * per_square_ * width_;
    square_mm2_ = c0.squaredNorm() - along * along * per_square_;
    bend_mm_ = 0.25 * (std::abs(c2.x()) + std::abs(c2.y()));
  }

  /// Columns [first, last) between x0 and x1 that may lie within a circle about the middle.
  [[nodiscard]] std::pair<int, int> reached(double radius_mm, int x0, int x1) const {
    return within(radius_mm + bend_mm_, kRoom_px, x0, x1);
  }
  /// Columns [first, last) between x0 and x1 that surely lie within a circle about the middle.
  [[nodiscard]] std::pair<int, int> covered(double radius_mm, int x0, int x1) const {
    return within(radius_mm - bend_mm_, -kRoom_px, x0, x1);
  }
  /// Place of a pixel, from the middle of the disc.
  struct Place {
    float x_mm, y_mm;
  };
  [[nodiscard]] Place at(int x) const {
    const float s = static_cast<float>(x - x0_) * (1.0F / static_cast<float>(width_));
    return {c0_.x() + s * (c1_.x() + s * c2_.x()), c0_.y() + s * (c1_.y() + s * c2_.y())};
  }

 private:
  static constexpr double kRoom_px = 0.01;  // More than floats round by.

  /// The row bends away from its chord by a quarter of c2 at most: circles are cut by the chord.
  [[nodiscard]] std::pair<int, int> within(double radius_mm, double room_px, int x0, int x1) const {
    const double square = radius_mm * radius_mm - square_mm2_;
    if (radius_mm <= 0.0 || !(square > 0.0)) return {x1, x1};
    const double half_px = std::sqrt(square * per_square_) * width_ + room_px;
    const auto clip = [&](double x) {
      return std::clamp(x, static_cast<double>(x0), static_cast<double>(x1));
    };
    const double first = clip(middle_px_ - half_px);
    const auto down = static_cast<int>(first);
    const int begin = down + (first > down ? 1 : 0);
    return {begin, std::max(begin, static_cast<int>(clip(middle_px_ + half_px + 1.0)))};
  }

  int x0_, width_;
  Eigen::Vector2f c0_, c1_, c2_;
  double bend_mm_{};
  double per_square_{};  // Inverse square of the length of the chord.
  double middle_px_{};  // Place of the chord that is nearest to the disc's middle, and its distance, squared.
  double square_mm2_{};
};

/// Pixels near the edge, from the disc's middle: taken several at a time, whichever rows they are of.
struct EdgePixels {
  static constexpr std::size_t kMost = 512;
  static constexpr std::size_t kLanes = 8;

  struct Run {
    float* light;
    std::size_t count;
  };
  std::size_t count{0};
  std::size_t run_count{0};
  std::array<float, kMost + kLanes> x_mm, y_mm, ink;
  std::array<Run, kMost> runs;
};

/// Adds the pixels [first, first + count) of a row; there must be room.
KERFBENCH_WIDE void collect(const RowOnPlane& row, int first, std::size_t count, float* line,
                            EdgePixels& pixels) {
  constexpr std::size_t kLanes = EdgePixels::kLanes;
  for (std::size_t begin = 0; begin < count; begin += kLanes) {
    float* const x_mm = pixels.x_mm.data() + pixels.count + begin;
    float* const y_mm = pixels.y_mm.data() + pixels.count + begin;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const RowOnPlane::Place place = row.at(first + static_cast<int>(begin + lane));
      x_mm[lane] = place.x_mm;
      y_mm[lane] = place.y_mm;
    }
  }
  pixels.runs[pixels.run_count++] = {line + first, count};
  pixels.count += count;
}

/// Adds the ink of a disc at one place.
KERFBENCH_WIDE void addInk(float place_x_mm, float place_y_mm, float radius_mm, float sigmas_per_mm,
                           EdgePixels& pixels) {
  KERFBENCH_INTERLEAVED
  for (std::size_t i = 0; i < pixels.count; ++i) {
    const float x = pixels.x_mm[i] - place_x_mm;
    const float y = pixels.y_mm[i] - place_y_mm;
    const float outside = (std::sqrt(x * x + y * y) - radius_mm) * sigmas_per_mm;
    const float least = outside > -kInkSigmas ? outside : -kInkSigmas;
    const float near = least < kInkSigmas ? least : kInkSigmas;
    const float blurred = 0.5F * wideErfc(near * (1.0F / std::numbers::sqrt2_v<float>));
    const float inside = near > -kInkSigmas ? blurred : 1.0F;
    pixels.ink[i] += near < kInkSigmas ? inside : 0.0F;
  }
}

/// Adds the ink to the light and empties the list.
void drawOn(EdgePixels& pixels, float gray) {
  const float* ink = pixels.ink.data();
  for (std::size_t k = 0; k < pixels.run_count; ++k) {
    const EdgePixels::Run& run = pixels.runs[k];
    for (std::size_t i = 0; i < run.count; ++i) run.light[i] += gray * ink[i];
    ink += run.count;
  }
  pixels.count = pixels.run_count = 0;
}

}  // namespace

DiscPainter::DiscPainter(const MarkImage& mark, const PlanePatch& patch, double blur_px,
                         double darkening_gray)
    : mark_(mark),
      patch_(patch),
      middle_mm_(mark.p_WM_mm[mark.p_WM_mm.size() / 2]),
      blur_mm_(blur_px / mark.px_per_mm),
      darkening_gray_(darkening_gray) {}

void DiscPainter::add(const PixelBox& box, std::vector<float>& light) const {
  const PixelBox drawn = mark_.box.within(box);
  if (drawn.empty()) return;
  const RingOfEdges ring(mark_, middle_mm_, double{kInkSigmas} * blur_mm_);
  const auto all_ink = static_cast<float>(darkening_gray_);
  const float per_place = all_ink / static_cast<float>(mark_.p_WM_mm.size());
  EdgePixels pixels;
  const auto draw = [&] {
    std::fill_n(pixels.ink.begin(), pixels.count, 0.0F);
    for (const Vector2d& place_mm : mark_.p_WM_mm) {
      const Eigen::Vector2f from_middle = (place_mm - middle_mm_).cast<float>();
      addInk(from_middle.x(), from_middle.y(), static_cast<float>(mark_.radius_mm),
             static_cast<float>(1.0 / blur_mm_), pixels);
    }
    drawOn(pixels, per_place);
  };
  for (int y = drawn.y0; y < drawn.y1; ++y) {
    const RowOnPlane row(patch_, mark_.box, y, middle_mm_);
    const auto [x0, x1] = row.reached(ring.outer_mm, drawn.x0, drawn.x1);
    const auto [ink0, ink1] = row.covered(ring.inner_mm, x0, x1);
    float* const line = light.data() + static_cast<std::ptrdiff_t>(y - box.y0) * (box.x1 - box.x0) - box.x0;
    for (int x = ink0; x < ink1; ++x) line[x] += all_ink;
    for (const auto& [begin, end] : {std::pair{x0, ink0}, {ink1, x1}}) {
      for (int x = begin; x < end;) {
        const std::size_t room = EdgePixels::kMost - pixels.count;
        const std::size_t count = std::min(static_cast<std::size_t>(end - x), room);
        collect(row, x, count, line, pixels);
        x += static_cast<int>(count);
        if (pixels.count == EdgePixels::kMost) draw();
      }
    }
  }
  draw();
}

}  // namespace kerfbench::twin
