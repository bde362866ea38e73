// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/deviation/line_smoother.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {

/// Circularity of a whole circle: the range of its radii about the least-squares circle (ISO 230-4), in mm.
///
/// Readings around a circle are fitted by waves of 1, 2, 3 … to the turn rather than piece by piece as an
/// open line is: a smooth departure is taken as it is, without rounding off its peaks. What changes in time,
/// as a machine's errors do, need not close where begin and end meet: a step and a kink there are fitted as
/// well, and readings whose windows reach over that seam are left out. As many waves are fitted as stand out
/// of the noise (Mallows 1973: the order at which the error of the fit is expected to be least). The waves
/// that were not tell the noise; of white noise a reading that is the mean over a window a leaves sin(k a/2)
/// / (k a/2) in the k-th.
class Roundness {
 public:
  /// `angle_rad`: direction of each reading from the nominal centre, from begin to end of the line;
  /// `window_rad`: what of the circle a reading is the mean over.
  Roundness(const ReadingLine& line, const std::vector<double>& angle_rad, double window_rad);

  /// False where so much of the circle was not seen that two waves to the turn cannot be told.
  [[nodiscard]] bool isKnown() const { return order_ >= kLeastOrder; }
  [[nodiscard]] int order() const { return order_; }  ///< Waves to the turn that were fitted.
  [[nodiscard]] double asRead() const { return as_read_mm_; }
  /// Range of a likely truth: the fitted waves, each drawn in by what noise is likely to have added to it.
  [[nodiscard]] double likely() const { return likely_mm_; }
  /// Ranges of the likely truth, measured with noise from `random` and these shared errors of its readings,
  /// one for each draw.
  [[nodiscard]] LineSmoother::Draws simulated(
      std::span<const CounterRandom, LineSmoother::kDrawsAtOnce> random,
      std::span<const LineSmoother::Draws> shift_mm) const;
  /// Standard uncertainty by waves that are too weak to be fitted: each of the two extremes may miss the
  /// amplitude at which one just would have been, either way (rectangular).
  [[nodiscard]] double unfittedSigma() const;
  /// Standard uncertainty by the step where the line closes: the beam's light there is from both sides.
  [[nodiscard]] double seamSigma() const;
  /// Share of the noise of the fit that the likely truth still holds, 0 … 1.
  [[nodiscard]] double noiseShare() const { return noise_share_; }

  static constexpr int kLeastOrder = 2;

 private:
  [[nodiscard]] double rangeOf(const Eigen::VectorXd& coefficient) const;
  [[nodiscard]] double noiseFrom(const Eigen::VectorXd& coefficient, Eigen::Index first,
                                 double expected) const;
  void chooseOrder(const Eigen::VectorXd& coefficient, int most, double noise);
  void findLikely(const Eigen::VectorXd& coefficient);

  std::size_t skipped_;        ///< Readings at each end.
  Eigen::MatrixXd basis_;      ///< Orthonormal columns: circle (3), seam (2), two for each further wave.
  Eigen::VectorXd through_;    ///< What windows leave of the noise of each, in that of slow ones.
  Eigen::MatrixXd radius_;     ///< What a coefficient makes of the radii about the least-squares circle.
  Eigen::VectorXd likely_of_;  ///< Coefficients of the likely truth.
  int order_{};
  double step_mm_{};   ///< Where the line closes.
  double noise_mm_{};  ///< Noise of each coefficient.
  double as_read_mm_{}, likely_mm_{}, noise_share_{};
};

}  // namespace kerfbench::inspect
