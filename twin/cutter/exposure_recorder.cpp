// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/exposure_recorder.h"

#include <cmath>

namespace kerfbench::twin {

ExposureRecorder::ExposureRecorder(const CameraDescription& camera, double step_s)
    : step_s_(step_s),
      period_(static_cast<std::uint64_t>(std::llround(camera.frame_period_s / step_s))),
      length_(static_cast<std::uint64_t>(std::llround(camera.exposure_s / step_s))),
      index_(period_ - 1) {}

void ExposureRecorder::record(const ExposureSample& sample) {
  if (index_ == 0) {
    open_.sequence = frame_++;
    open_.start_s = static_cast<double>(step_ - 1) * step_s_;
    open_.samples.clear();
    open_.samples.reserve(length_);
  }
  open_.samples.push_back(sample);
  if (index_ + 1 == length_) ended_.push_back(std::move(open_));
}

}  // namespace kerfbench::twin
