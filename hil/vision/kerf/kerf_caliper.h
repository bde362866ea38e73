// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/kerf/kerf_profile.h"

namespace kerfbench::vision {

/// Kerf in one profile, with more than a Caliper reports.
struct KerfReading {
  bool found{};
  double offset_mm{};
  double width_mm{};
  double low_width_mm{}, high_width_mm{};  ///< At a quarter and three quarters of the height; NaN if hidden.
  double brightness{};
  double noise_mm{};  ///< Noise of the offset, as the noise of the pixels alone would make it.
  double top_gray{};
  double base_gray{};
  /// Left minus right at kBesidePx beyond the flanks, mirrored about the centre; NaN where hidden.
  double odd_gray{};
  /// Shift of the centre that the same difference on whole board, kBoardMm from the centre, would make if it
  /// lay on the flanks, as grain of the board does. NaN where hidden.
  double board_mm{};
};

/// Distance outside of the flanks at which a kerf is compared with its mirror image, px.
inline constexpr double kBesidePx = 2.75;

/// Distance from the centre of a kerf to plain board, beyond any visible scorch.
inline constexpr double kBoardMm = 0.45;

/// The kerf in a profile that lies nearest to the nominal place. `open_gray`: brightness 1.
///
/// A flank lies where the light crosses 0.4, 0.5 and 0.6 of the kerf's height, on average; the centre is the
/// middle of both flanks, and the width is that at half height.
KerfReading measureKerf(const Profile& profile, double open_gray);

}  // namespace kerfbench::vision
