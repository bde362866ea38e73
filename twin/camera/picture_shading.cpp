// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/picture_shading.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr std::uint64_t kHotStream = 0x686f74;

}  // namespace

PictureShading::PictureShading(const CameraDescription& camera)
    : width_(camera.width_px),
      height_(camera.height_px),
      light_(camera.light),
      lamp_(camera.light.gradient_x != 0.0 || camera.light.gradient_y != 0.0),
      lens_(camera.light.vignette > 0.0) {
  const auto pixels = static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_);
  const auto count = static_cast<std::uint64_t>(std::llround(camera.hot.share * static_cast<double>(pixels)));
  const CounterRandom random(camera.hot.seed, kHotStream);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto place = random.bits(2 * i) % pixels;
    const auto width = static_cast<std::uint64_t>(width_);
    hot_.push_back({static_cast<int>(place % width), static_cast<int>(place / width),
                    static_cast<float>(camera.hot.gray * (0.25 + 0.75 * random.uniform(2 * i + 1)))});
  }
  const auto at = [](const HotPixel& pixel) { return std::pair(pixel.y, pixel.x); };
  std::stable_sort(hot_.begin(), hot_.end(),
                   [&](const HotPixel& a, const HotPixel& b) { return at(a) < at(b); });
  const auto same = [&](const HotPixel& a, const HotPixel& b) { return at(a) == at(b); };
  hot_.erase(std::unique(hot_.begin(), hot_.end(), same), hot_.end());
}

void PictureShading::shadeByLamp(const PixelWindow& window, std::span<float> light) const {
  if (!lamp_) return;
  float* pixel = light.data();
  const auto step = static_cast<float>(light_.gradient_x / width_);
  for (int y = window.top; y <= window.bottom(); ++y) {
    const double down = light_.gradient_y * ((y + 0.5) / height_ - 0.5);
    const auto first = static_cast<float>(1.0 + down - 0.5 * light_.gradient_x) + 0.5F * step;
    for (int x = window.left; x <= window.right(); ++x) *pixel++ *= first + step * static_cast<float>(x);
  }
}

void PictureShading::shadeByLens(const PixelWindow& window, std::span<float> light) const {
  if (!lens_) return;
  float* pixel = light.data();
  const double middle_x = 0.5 * (width_ - 1);
  const double middle_y = 0.5 * (height_ - 1);
  const double share = light_.vignette / (middle_x * middle_x + middle_y * middle_y);
  for (int y = window.top; y <= window.bottom(); ++y) {
    const auto row = static_cast<float>(1.0 - share * (y - middle_y) * (y - middle_y));
    for (int x = window.left; x <= window.right(); ++x) {
      const float across = static_cast<float>(x) - static_cast<float>(middle_x);
      *pixel++ *= row - static_cast<float>(share) * across * across;
    }
  }
}

void PictureShading::addHotPixels(std::span<float> picture) const {
  for (const HotPixel& pixel : hot_)
    picture[static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(pixel.x)] += pixel.gray;
}

}  // namespace kerfbench::twin
