// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "hil/inspect/deviation/error_model.h"

namespace kerfbench::inspect {

/// Takes noise out of the readings along a line by a local parabola (least squares over a window of
/// neighbours), the window as wide as the data allow at each place.
///
/// Widths are tried from the narrowest: 1, 5, 9, 17, 33 readings. Each gives an interval estimate ± 2.5
/// sigma; the widest is taken whose interval still meets those of all narrower ones (intersection of
/// confidence intervals: Goldenshluger and Nemirovski 1997) and whose parabola leaves no more scatter than
/// noise does. So a smooth cut is averaged over 33 readings, and a step or a notch of one reading keeps its
/// height. Windows do not reach across a gap.
class LineSmoother {
 public:
  class Kernels;
  /// `kernels`: those that lines have in common; null: the line has its own. Keeps a reference to the line;
  /// it must outlive this.
  explicit LineSmoother(const ReadingLine& line, std::shared_ptr<Kernels> kernels = nullptr);

  /// Estimates from readings of the same line, e.g. those of the line itself or simulated ones; the width
  /// chosen for each goes to `level` unless that is null.
  void smooth(const std::vector<double>& reading_mm, std::vector<double>& estimate_mm,
              std::vector<std::uint8_t>* level) const;
  /// The estimate with the windows fixed: linear in the readings.
  void apply(const std::vector<double>& reading_mm, const std::vector<std::uint8_t>& level,
             std::vector<double>& estimate_mm) const;
  /// Several simulated measurements of the line that are smoothed together, since processors compute several
  /// numbers at once: one of each.
  static constexpr std::size_t kDrawsAtOnce = 8;
  using Draws = std::array<double, kDrawsAtOnce>;
  void apply(const std::vector<Draws>& reading_mm, const std::vector<std::uint8_t>& level,
             std::vector<Draws>& estimate_mm) const;
  /// Standard uncertainty of an estimate by the readings' noise.
  [[nodiscard]] double sigma(std::size_t reading, std::uint8_t level) const {
    return sigma_mm_[level][reading];
  }
  /// Correlation of the noise of the estimates of a reading and the one before it in its segment.
  [[nodiscard]] double correlationWithPrevious(std::size_t reading,
                                               const std::vector<std::uint8_t>& level) const;

  static constexpr std::array<std::size_t, 5> kHalf{0, 2, 4, 8, 16};

 private:
  /// A parabola over readings -left … right.
  struct Kernel {
    std::vector<double> weight;  ///< Weights of the readings in its value at 0.
    Eigen::MatrixXd rest;        ///< Turns readings into what the parabola leaves of them.
    double expected_rest{};      ///< Mean square of that for noise of sigma 1.
  };
  struct Window {
    std::size_t first{};
    const Kernel* kernel{};
  };
  [[nodiscard]] bool fits(const Window& window, const std::vector<double>& reading_mm) const;
  [[nodiscard]] double covariance(const Window& a, const Window& b) const;
  static double apply(const Window& window, const std::vector<double>& reading_mm);

  const ReadingLine& line_;
  std::shared_ptr<Kernels> kernels_;
  std::array<std::vector<Window>, kHalf.size()> window_;
  std::array<std::vector<double>, kHalf.size()> sigma_mm_;
  std::vector<std::uint8_t> levels_;  ///< How many widths fit at each reading.
};

/// Kernels by the correlation of neighbours' noise and the readings on either side, made when they are asked
/// for first: a third of a megabyte for a line, and the same for all lines with readings as dense. Several
/// threads may ask.
class LineSmoother::Kernels {
 public:
  const Kernel& kernelFor(double q, std::size_t left, std::size_t right);

 private:
  std::mutex mutex_;
  std::map<std::tuple<double, std::size_t, std::size_t>, Kernel> kernels_;
};

}  // namespace kerfbench::inspect
