// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace kerfbench::vision {

/// Noise of a pixel: read noise and, growing with the light, shot noise.
struct PixelNoise {
  double board_gray{};      ///< Gray of the plain board.
  double board_variance{};  ///< Variance on the plain board, gray².
  double per_gray{};        ///< Variance for each grey of light; in [0, board_variance / board_gray].

  [[nodiscard]] double variance(double gray) const {
    return std::max(0.05 * board_variance, board_variance + per_gray * (std::min(gray, 255.0) - board_gray));
  }
};

/// Evidence of shot noise in the pixels of a spot: how far they lie off the fitted spot, against how much
/// brighter than the board they are.
struct ShotEvidence {
  double products{};
  double squares{};
};

/// The camera's shot noise, from the spots of the frames so far. Before any spot, shot noise is taken for
/// four fifths of the noise of the board, as a camera that is well used has it.
class ShotNoise {
 public:
  [[nodiscard]] PixelNoise on(double board_gray, double board_sigma) const {
    const double variance = board_sigma * board_sigma;
    const double most = variance / std::max(1.0, board_gray);
    constexpr double kUsual = 0.8;
    constexpr double kBelief = 5.0;  // spots
    const double usual_squares = spots_ > 0.0 ? kBelief * sum_.squares / spots_ : 1.0;
    const double per_gray = (kUsual * most * usual_squares + sum_.products) / (usual_squares + sum_.squares);
    return {board_gray, variance, std::clamp(per_gray, 0.0, most)};
  }
  void add(const ShotEvidence& evidence) {
    if (!(evidence.squares > 0.0)) return;
    sum_.products += evidence.products;
    sum_.squares += evidence.squares;
    spots_ += 1.0;
  }

 private:
  ShotEvidence sum_;
  double spots_{};
};

}  // namespace kerfbench::vision
