// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/deviation/line_smoother.h"
#include "hil/inspect/deviation/roundness.h"
#include "hil/inspect/deviation/worst_deviation.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {

/// Largest magnitude; NaN if any value is.
double largestOf(const std::vector<double>& values);

/// Sum of the squares of the values, about zero or about their mean.
double sumOfSquares(const std::vector<double>& values, LineKind::Rms about);

/// Expected sum of squares of the errors of a line's readings.
double errorSquaresOf(const ReadingLine& line);

constexpr std::size_t kDrawsAtOnce = LineSmoother::kDrawsAtOnce;
using Draws = LineSmoother::Draws;

/// The same of each draw.
Draws largestOf(std::span<const Draws> values);
Draws sumOfSquares(std::span<const Draws> values, LineKind::Rms about);

/// Simulated measurements of one line, one number for each reading and draw.
struct SimulatedReadings {
  std::vector<Draws> reading_mm;
  std::vector<Draws> shift_mm;      ///< What the shared errors made of them.
  std::vector<Draws> simulated_mm;  ///< Readings, smoothed.
  std::vector<double> noise;        ///< Draw by draw.
};

/// One line with all that simulated measurements of it need.
class SimulatedLine {
 public:
  /// Keeps references to the line; it must outlive this. `kernels` as of LineSmoother.
  SimulatedLine(const ReadingLine& line, const LineKind& kind,
                std::shared_ptr<LineSmoother::Kernels> kernels = nullptr);

  /// Columns of ReadingLine::shared that are not all nought: the others' errors need not be drawn.
  [[nodiscard]] const std::vector<Eigen::Index>& columns() const { return columns_; }
  /// Fills `into`: the likely truth with the noise of a stream for each draw, from the counter `first` on,
  /// and the shared errors, one for each of columns().
  void measure(std::span<const CounterRandom, kDrawsAtOnce> noise, std::uint64_t first,
               std::span<const Draws> shared_error, SimulatedReadings& into) const;

  [[nodiscard]] const LineSmoother& smoother() const { return smoother_; }
  /// The likely truth as it is measured without noise.
  [[nodiscard]] std::vector<double> seen() const;
  /// Only of a whole circle.
  [[nodiscard]] const std::optional<Roundness>& roundness() const { return roundness_; }
  /// Standard uncertainty of a reading's estimate, by noise and shared errors.
  [[nodiscard]] double errorAt(std::size_t reading) const;
  /// Share of the variance of the errors at a reading's estimate that the likely truth still holds: all of
  /// what is shared, noise_share of the noise.
  [[nodiscard]] double errorShareAt(std::size_t reading) const;

  LineKind::Rms rms{};
  std::vector<double> estimate_mm;  ///< Smoothed readings.
  std::vector<std::uint8_t> level;  ///< With which windows.
  std::vector<double> likely_mm;    ///< The likely truth.
  double noise_share{};             ///< Share of the estimates' noise variance that likely_mm still holds.

 private:
  [[nodiscard]] std::vector<double> likelyTruth();

  const ReadingLine& line_;
  LineSmoother smoother_;
  std::vector<Eigen::Index> columns_;
  std::vector<double> weights_;  ///< Each reading's row of ReadingLine::shared, in columns_, mm.
  std::optional<Roundness> roundness_;
};

}  // namespace kerfbench::inspect
