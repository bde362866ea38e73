// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/disc_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/LU>

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

/// Pixels of a row that the ring may reach, and those that surely lie within its inner circle: of the others
/// nothing need be computed. The picture of a circle lies between two circles of pixels.
class RowsOfRing {
 public:
  RowsOfRing(const RingOfEdges& ring, const Vector2d& middle_px, const Eigen::Matrix2d& px_per_mm)
      : middle_px_(middle_px) {
    // The singular values, and some room for a scale that changes over the mark.
    constexpr double kScale = 0.02;
    constexpr double kRoom_px = 0.75;
    const double mean = 0.5 * px_per_mm.squaredNorm();
    const double spread = std::sqrt(std::max(0.0, mean * mean - std::pow(px_per_mm.determinant(), 2)));
    outer_px_ = (1.0 + kScale) * std::sqrt(mean + spread) * ring.outer_mm + kRoom_px;
    inner_px_ = (1.0 - kScale) * std::sqrt(mean - spread) * ring.inner_mm - kRoom_px;
  }
  /// Columns [first, last) of row y that may have ink.
  [[nodiscard]] std::pair<int, int> reached(int y, const PixelBox& box) const {
    return within(outer_px_, y, box);
  }
  /// Columns [first, last) of row y that have nothing but ink; never more than those reached.
  [[nodiscard]] std::pair<int, int> covered(int y, const PixelBox& box) const {
    return within(inner_px_, y, box);
  }

 private:
  [[nodiscard]] std::pair<int, int> within(double radius_px, int y, const PixelBox& box) const {
    const double down = y - middle_px_.y();
    const double square = radius_px * radius_px - down * down;
    if (radius_px <= 0.0 || square <= 0.0) return {box.x1, box.x1};
    const double half = std::sqrt(square);
    const auto clip = [&](double x) {
      return static_cast<int>(std::clamp(x, static_cast<double>(box.x0), static_cast<double>(box.x1)));
    };
    return {clip(std::ceil(middle_px_.x() - half)), clip(std::floor(middle_px_.x() + half) + 1.0)};
  }

  Vector2d middle_px_;
  double outer_px_{};
  double inner_px_{};
};

/// Pixels near the edge, from the disc's middle: taken several at a time, whichever rows they are of.
struct EdgePixels {
  static constexpr std::size_t kMost = 512;
  std::size_t count{0};
  std::array<float, kMost> x_mm, y_mm, ink;
  std::array<float*, kMost> light;
};

/// Adds the ink of a disc at one place.
KERFBENCH_WIDE void addInk(float place_x_mm, float place_y_mm, float radius_mm, float sigmas_per_mm,
                           EdgePixels& pixels) {
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

}  // namespace

DiscPainter::DiscPainter(const MarkImage& mark, const PlanePatch& patch, const PlaneProjection& projection,
                         double blur_px, double darkening_gray)
    : mark_(mark),
      patch_(patch),
      middle_mm_(mark.p_WM_mm[mark.p_WM_mm.size() / 2]),
      middle_px_(projection.pixelOf(middle_mm_)),
      px_per_mm_(projection.jacobianAt(middle_mm_)),
      blur_mm_(blur_px / mark.px_per_mm),
      darkening_gray_(darkening_gray) {}

void DiscPainter::add(const PixelBox& box, std::vector<float>& light) const {
  const PixelBox& own = mark_.box;
  const PixelBox drawn = own.within(box);
  if (!middle_px_ || drawn.empty()) return;
  const RowsOfRing rows(RingOfEdges(mark_, middle_mm_, double{kInkSigmas} * blur_mm_), *middle_px_,
                        px_per_mm_);
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
    for (std::size_t i = 0; i < pixels.count; ++i) *pixels.light[i] += per_place * pixels.ink[i];
    pixels.count = 0;
  };
  for (int y = drawn.y0; y < drawn.y1; ++y) {
    float* const line = light.data() + static_cast<std::ptrdiff_t>(y - box.y0) * (box.x1 - box.x0) - box.x0;
    const double t = (y - own.y0) / static_cast<double>(own.y1 - own.y0);
    const Eigen::Vector2f c0 = (patch_.alongRow(t, 0) - middle_mm_).cast<float>();
    const Eigen::Vector2f c1 = patch_.alongRow(t, 1).cast<float>();
    const Eigen::Vector2f c2 = patch_.alongRow(t, 2).cast<float>();
    const float per_pixel = 1.0F / static_cast<float>(own.x1 - own.x0);
    const auto collect = [&](int x0, int x1) {
      for (int x = x0; x < x1; ++x) {
        const float s = static_cast<float>(x - own.x0) * per_pixel;
        pixels.x_mm[pixels.count] = c0.x() + s * (c1.x() + s * c2.x());
        pixels.y_mm[pixels.count] = c0.y() + s * (c1.y() + s * c2.y());
        pixels.light[pixels.count++] = line + x;
        if (pixels.count == EdgePixels::kMost) draw();
      }
    };
    const auto [x0, x1] = rows.reached(y, drawn);
    const auto [ink0, ink1] = rows.covered(y, {x0, drawn.y0, x1, drawn.y1});
    collect(x0, ink0);
    for (int x = ink0; x < ink1; ++x) line[x] += all_ink;
    collect(ink1, x1);
  }
  draw();
}

}  // namespace kerfbench::twin
