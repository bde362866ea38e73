// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/sensor_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "twin/base/image.h"

namespace kerfbench::twin {
namespace {

constexpr std::size_t kQuantiles = 4096;
constexpr std::size_t kChunk = 256;

std::array<float, kQuantiles> makeQuantiles() {
  std::array<double, kQuantiles> quantile{};
  double square_sum = 0.0;
  double x = -4.0;
  for (std::size_t i = 0; i < kQuantiles; ++i) {
    const double p = (static_cast<double>(i) + 0.5) / kQuantiles;
    // Newton on the distribution function; the last quantile is a good start but in the tail, hence the
    // damping.
    for (int step = 0; step < 60; ++step) {
      const double miss = 0.5 * std::erfc(-x / std::numbers::sqrt2) - p;
      const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
      x -= std::clamp(miss / density, -0.5, 0.5);
    }
    quantile[i] = x;
    square_sum += x * x;
  }
  const double scale = 1.0 / std::sqrt(square_sum / kQuantiles);
  std::array<float, kQuantiles> out{};
  for (std::size_t i = 0; i < kQuantiles; ++i) out[i] = static_cast<float>(quantile[i] * scale);
  return out;
}

/// Four pixels share 64 random bits, 16 each, of which the lower 12 are used.
void sampleNormals(const std::array<float, kQuantiles>& table, const CounterRandom& random,
                   std::uint64_t index, std::size_t count, float* out) {
  std::size_t i = 0;
  while (i < count) {
    std::uint64_t bits = random.bits((index + i) / 4);
    const std::uint64_t lane = (index + i) % 4;
    if (lane == 0 && i + 4 <= count) {
      for (std::size_t j = 0; j < 4; ++j, bits >>= 16U) out[i + j] = table[bits % kQuantiles];
      i += 4;
    } else {
      out[i++] = table[(bits >> (16U * lane)) % kQuantiles];
    }
  }
}

}  // namespace

const std::array<float, kQuantiles>& normalQuantiles() {
  static const std::array<float, kQuantiles> table = makeQuantiles();
  return table;
}

SensorNoise::SensorNoise(double read_noise, double full_well_electrons, int bits)
    : read_variance_(static_cast<float>(read_noise * read_noise)),
      shot_variance_per_gray_(static_cast<float>(255.0 / full_well_electrons)),
      bits_(bits) {}

template <typename Level>
void SensorNoise::exposeAs(std::span<const float> light, const CounterRandom& random,
                           std::uint64_t first_index, Level* out) const {
  const auto& table = normalQuantiles();
  const auto levels_per_gray = static_cast<float>(1 << (bits_ - 8));
  const auto top = static_cast<float>((1 << bits_) - 1);
  std::array<float, kChunk> normal;
  for (std::size_t begin = 0; begin < light.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, light.size() - begin);
    sampleNormals(table, random, first_index + begin, count, normal.data());
    const float* const in = light.data() + begin;
    Level* const to = out + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const float variance = in[i] * shot_variance_per_gray_ + read_variance_;
      float level = in[i] + std::sqrt(variance > 0.0F ? variance : 0.0F) * normal[i];
      if constexpr (sizeof(Level) > 1) level *= levels_per_gray;
      level = level > 0.0F ? level : 0.0F;
      level = level < top ? level : top;
      to[i] = static_cast<Level>(static_cast<int>(level + 0.5F));
    }
  }
}

void SensorNoise::expose(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
                         std::uint8_t* out) const {
  exposeAs(light, random, first_index, out);
}

void SensorNoise::expose(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
                         std::uint16_t* out) const {
  exposeAs(light, random, first_index, out);
}

GrayImage SensorNoise::picture(std::span<const float> light, int width, int height,
                               const CounterRandom& random) const {
  if (bits_ == 8) {
    GrayImage image(width, height);
    expose(light, random, 0, image.pixels.data());
    return image;
  }
  std::vector<std::uint16_t> levels(light.size());
  expose(light, random, 0, levels.data());
  return GrayImage::ofLevels(width, height, bits_, std::move(levels));
}

}  // namespace kerfbench::twin
