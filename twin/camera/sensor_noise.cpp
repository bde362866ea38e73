// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/sensor_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "twin/base/image.h"
#include "twin/base/multiversion.h"

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

constexpr std::size_t kPerWord = 4;
constexpr std::size_t kWords = kChunk / kPerWord;

KERFBENCH_WIDE void drawWords(const CounterRandom& random, std::uint64_t first, std::size_t count,
                              std::uint64_t* words) {
  for (std::size_t i = 0; i < count; ++i) words[i] = random.bits(first + i);
}

/// Normal deviates of at most kChunk pixels. Four pixels share 64 random bits, 16 each, of which the lower 12
/// are used.
class NormalDraws {
 public:
  /// Draws for the pixels from `index` on; valid until the next draw.
  const float* draw(const CounterRandom& random, std::uint64_t index, std::size_t count) {
    const auto skipped = static_cast<std::size_t>(index % kPerWord);
    const std::size_t word_count = (skipped + count + kPerWord - 1) / kPerWord;
    drawWords(random, index / kPerWord, word_count, words_.data());
    for (std::size_t i = 0; i < word_count; ++i) {
      for (std::size_t lane = 0; lane < kPerWord; ++lane)
        normals_[kPerWord * i + lane] = table_[(words_[i] >> (16U * lane)) % kQuantiles];
    }
    return normals_.data() + skipped;
  }

 private:
  const std::array<float, kQuantiles>& table_ = normalQuantiles();
  // The first and the last word may be used in part.
  std::array<std::uint64_t, kWords + 1> words_;
  std::array<float, kChunk + kPerWord> normals_;
};

/// What turns light and a normal deviate into a level.
struct Sensor {
  float read_variance, shot_variance_per_gray;
  float levels_per_gray, top;

  [[nodiscard]] int levelOf(float light, float normal) const {
    const float variance = light * shot_variance_per_gray + read_variance;
    float level = (light + std::sqrt(variance > 0.0F ? variance : 0.0F) * normal) * levels_per_gray;
    level = level > 0.0F ? level : 0.0F;
    level = level < top ? level : top;
    return static_cast<int>(level + 0.5F);
  }
};

KERFBENCH_WIDE void toLevels(const Sensor& sensor, std::span<const float> light, const float* normal,
                             std::uint8_t* out) {
  for (std::size_t i = 0; i < light.size(); ++i)
    out[i] = static_cast<std::uint8_t>(sensor.levelOf(light[i], normal[i]));
}
KERFBENCH_WIDE void toLevels(const Sensor& sensor, std::span<const float> light, const float* normal,
                             std::uint16_t* out) {
  for (std::size_t i = 0; i < light.size(); ++i)
    out[i] = static_cast<std::uint16_t>(sensor.levelOf(light[i], normal[i]));
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
  const Sensor sensor{read_variance_, shot_variance_per_gray_, static_cast<float>(1 << (bits_ - 8)),
                      static_cast<float>((1 << bits_) - 1)};
  NormalDraws normals;
  for (std::size_t begin = 0; begin < light.size(); begin += kChunk) {
    const std::span<const float> chunk = light.subspan(begin, std::min(kChunk, light.size() - begin));
    toLevels(sensor, chunk, normals.draw(random, first_index + begin, chunk.size()), out + begin);
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
