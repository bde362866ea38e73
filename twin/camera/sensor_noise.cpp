// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/sensor_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

const std::array<float, kQuantiles>& quantiles() {
  static const std::array<float, kQuantiles> table = makeQuantiles();
  return table;
}

/// Four pixels share 64 random bits, 16 each, of which the lower 12 are used.
void drawNormals(const std::array<float, kQuantiles>& table, const CounterRandom& random, std::uint64_t index,
                 std::size_t count, float* out) {
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

SensorNoise::SensorNoise(double read_noise, double full_well_electrons)
    : read_variance_(static_cast<float>(read_noise * read_noise)),
      shot_variance_per_gray_(static_cast<float>(255.0 / full_well_electrons)) {}

void SensorNoise::expose(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
                         std::uint8_t* out) const {
  const auto& table = quantiles();
  std::array<float, kChunk> normal;
  for (std::size_t begin = 0; begin < light.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, light.size() - begin);
    drawNormals(table, random, first_index + begin, count, normal.data());
    const float* const in = light.data() + begin;
    std::uint8_t* const to = out + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const float variance = in[i] * shot_variance_per_gray_ + read_variance_;
      float gray = in[i] + std::sqrt(variance > 0.0F ? variance : 0.0F) * normal[i];
      gray = gray > 0.0F ? gray : 0.0F;
      gray = gray < 255.0F ? gray : 255.0F;
      to[i] = static_cast<std::uint8_t>(static_cast<int>(gray + 0.5F));
    }
  }
}

}  // namespace kerfbench::twin
