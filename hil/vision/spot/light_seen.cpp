// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/light_seen.h"

#include <numbers>

#include "hil/vision/image/brightness_scan.h"
#include "hil/vision/spot/spot_fit.h"
#include "hil/vision/spot/spot_noise.h"
#include "twin/base/image.h"

namespace kerfbench::vision {

double spotLight(const GrayImage& image) {
  constexpr std::size_t kCandidates = 4;
  const BrightnessScan scan = scanBrightness(image, kCandidates);
  const PixelNoise noise = ShotNoise().on(scan.background.median(), scan.background.noise());
  for (const BrightPeak& peak : scan.peaks) {
    const auto fit = fitSpot(image, peak, scan.background.at(peak.column, peak.row), noise);
    if (fit) return 2.0 * std::numbers::pi * fit->height_gray * fit->long_sigma_px * fit->short_sigma_px;
  }
  return 0.0;
}

}  // namespace kerfbench::vision
