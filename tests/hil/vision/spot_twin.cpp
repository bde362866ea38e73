// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/vision/spot_twin.h"

#include <numbers>

#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"

namespace kerfbench::vision::test {

twin::CameraDescription spotCamera(int width_px, int height_px) {
  twin::CameraDescription camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = 5000.0;
  camera.fy_px = 5010.0;
  camera.cx_px = 0.5 * width_px + 3.7;
  camera.cy_px = 0.5 * height_px - 5.2;
  camera.distortion = {-0.15, 0.05, 2e-4, -3e-4, 0.01};
  camera.X_CP = Eigen::Translation3d(0.0, 0.0, 500.0) *
                Eigen::AngleAxisd(0.07, Eigen::Vector3d(1.0, 0.4, 0.2).normalized()) *
                Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  return camera;
}

twin::Exposure exposureOf(std::uint64_t sequence, const Eigen::Vector2d& middle_mm,
                          const Eigen::Vector2d& streak_mm, double gray) {
  twin::Exposure exposure;
  exposure.sequence = sequence;
  exposure.start_s = 1e-3 * static_cast<double>(sequence);
  constexpr int kSamples = 8;
  for (int i = 0; i < kSamples; ++i) {
    twin::ExposureSample& sample = exposure.samples.emplace_back();
    sample.p_WQ_mm = middle_mm + streak_mm * ((i + 0.5) / kSamples - 0.5);
    sample.radius_mm = kSpotRadiusMm;
    sample.power_w = gray / kGlowGrayPerW;
  }
  return exposure;
}

PrintLayout noPrint() {
  PrintLayout print;
  print.pitch_mm = 100.0;
  return print;
}

SpotTrack trackOf(const twin::CameraDescription& camera, const PrintLayout& print, std::vector<Frame> frames,
                  double speed_mm_s) {
  ReadyFrames source(std::move(frames));
  return trackSpot(source, calibrationOf(camera), print, {1, speed_mm_s});
}

}  // namespace kerfbench::vision::test
