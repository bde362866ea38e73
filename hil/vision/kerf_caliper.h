// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/kerf_profile.h"

namespace kerfbench::hil {

/// What a profile tells of a kerf, beyond what a Caliper reports.
struct KerfReading {
  bool found{};
  double offset_mm{};
  double width_mm{};
  double brightness{};
  double noise_mm{};  ///< Of the offset, as the noise of the pixels alone would make it.
  double top_gray{};
  double base_gray{};
};

/// The kerf in a profile that lies nearest to the nominal place. `open_gray`: brightness 1.
///
/// Each flank has a board of its own: scorch darkens one side and not the other. A flank lies where the light
/// crosses 0.6 … 0.8 of the way from its own board to the top of the kerf; the centre is the middle of both
/// flanks, and the width is that at half of the way.
KerfReading measureKerf(const Profile& profile, double open_gray);

}  // namespace kerfbench::hil
