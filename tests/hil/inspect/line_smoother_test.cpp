// SPDX-License-Identifier: Apache-2.0
// Smoothing along a line, compared with truths that are known.
#include "hil/inspect/deviation/line_smoother.h"

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

constexpr std::size_t kLineReadings = 240;

struct Case {
  const char* name;
  double q;  ///< Correlation of the noise of neighbours; its sigma is 1.
  std::function<double(double)> truth;
  double most_z{1.1};
};

/// RMS of the estimates' errors relative to their stated ones, and of the errors alone.
struct Errors {
  double z{};
  double rms{};
};

Errors errorsOf(const Case& one) {
  constexpr std::uint64_t kLines = 200;
  double z2 = 0.0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= kLines; ++seed) {
    const CounterRandom random(seed, 4);
    ReadingLine line;
    line.q = one.q;
    double noise = random.normal(0);
    for (std::size_t i = 0; i < kLineReadings; ++i) {
      if (i > 0) noise = one.q * noise + std::sqrt(1.0 - one.q * one.q) * random.normal(i);
      line.reading_mm.push_back(one.truth(static_cast<double>(i)) + noise);
      line.sigma_mm.push_back(1.0);
    }
    line.segment = {0, kLineReadings};
    const LineSmoother smoother(line);
    std::vector<double> estimate;
    std::vector<std::uint8_t> level;
    smoother.smooth(line.reading_mm, estimate, &level);
    for (std::size_t i = 0; i < kLineReadings; ++i) {
      const double error = estimate[i] - one.truth(static_cast<double>(i));
      squares += error * error / (kLineReadings * kLines);
      z2 += std::pow(error / smoother.sigma(i, level[i]), 2) / (kLineReadings * kLines);
    }
  }
  return {std::sqrt(z2), std::sqrt(squares)};
}

// A smooth line is known far better than one reading; a rough one must not be taken for smooth: the part that
// smoothing rounds off must stay far below the stated noise of the estimates.
TEST(LineSmoother, EstimatesAreAsGoodAsTheyState) {
  const auto wave = [](double length, double size) {
    return [=](double i) { return size * std::sin(2.0 * std::numbers::pi * i / length); };
  };
  const std::vector<Case> cases{
      {"straight", 0.0, [](double) { return 3.0; }},
      {"straight, noise in common", 0.6, [](double) { return 3.0; }},
      {"long wave", 0.3, wave(80.0, 10.0)},
      // The wave is somewhat rounded off; the effect on a maximum has its own place in the budget.
      {"short wave", 0.3, wave(14.0, 4.0), 1.35},
      {"bump", 0.3, [](double i) { return 8.0 * std::exp(-0.5 * std::pow((i - 120.0) / 3.0, 2)); }},
      {"step", 0.0, [](double i) { return i < 120.0 ? 0.0 : 8.0; }},
  };
  for (const Case& one : cases) {
    const Errors e = errorsOf(one);
    std::printf("  %-26s rms %.3f of one reading's noise, z %.3f\n", one.name, e.rms, e.z);
    EXPECT_LT(e.z, one.most_z) << one.name;
    EXPECT_GT(e.z, 0.9) << one.name;
    EXPECT_LT(e.rms, 0.95) << one.name;
  }
  EXPECT_LT(errorsOf(cases[0]).rms, 0.5) << "on a straight line";
}

/// Readings of pure noise of this correlation.
ReadingLine noiseOf(double q, std::uint64_t seed, std::size_t count) {
  const CounterRandom random(seed, 5);
  ReadingLine line;
  line.q = q;
  double noise = random.normal(0);
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) noise = q * noise + std::sqrt(1.0 - q * q) * random.normal(i);
    line.reading_mm.push_back(noise);
    line.sigma_mm.push_back(1.0);
  }
  line.segment = {0, count};
  return line;
}

TEST(LineSmoother, StatesHowAlikeTheEstimatesOfNeighboursAre) {
  constexpr std::size_t kCount = 12;
  constexpr int kLines = 4000;
  // Windows of one reading, of five and of nine beside each other; only that of one fits at the very ends.
  const std::vector<std::uint8_t> level{0, 0, 2, 1, 2, 2, 2, 1, 0, 2, 0, 0};
  std::vector<double> products(kCount), squares(kCount);
  const ReadingLine first = noiseOf(0.5, 1, kCount);
  const LineSmoother smoother(first);
  std::vector<double> estimate;
  for (std::uint64_t seed = 1; seed <= kLines; ++seed) {
    smoother.apply(noiseOf(0.5, seed, kCount).reading_mm, level, estimate);
    for (std::size_t i = 0; i < kCount; ++i) {
      squares[i] += estimate[i] * estimate[i];
      if (i > 0) products[i] += estimate[i] * estimate[i - 1];
    }
  }
  for (std::size_t i = 1; i < kCount; ++i) {
    EXPECT_NEAR(smoother.correlationWithPrevious(i, level),
                products[i] / std::sqrt(squares[i] * squares[i - 1]), 4.0 / std::sqrt(kLines))
        << i;
  }
}

TEST(LineSmoother, NoiseThatNeighboursShareIsNotTakenForAShape) {
  // Where noise is all that there is, the widest window is good nearly everywhere, however alike neighbours
  // are.
  for (const double q : {0.0, 0.5, 0.8}) {
    std::size_t widest = 0;
    std::size_t all = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const ReadingLine line = noiseOf(q, seed, kLineReadings);
      const LineSmoother smoother(line);
      std::vector<double> estimate;
      std::vector<std::uint8_t> level;
      smoother.smooth(line.reading_mm, estimate, &level);
      for (std::size_t i = 20; i + 20 < kLineReadings; ++i, ++all) widest += level[i] == 4 ? 1 : 0;
    }
    EXPECT_GT(static_cast<double>(widest), 0.94 * static_cast<double>(all)) << q;
  }
}

}  // namespace
}  // namespace kerfbench::inspect
