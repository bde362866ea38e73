// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "twin/camera/camera.h"

namespace kerfbench::twin {

/// Records the scene of the spot camera: a sample for each step of the machine in which its shutter is open.
/// Memory, until the exposures are taken: 64 bytes for each such step and 64 for each exposure.
class ExposureRecorder {
 public:
  /// Makes a recorder with shutter and frame period in whole steps, at least one.
  ExposureRecorder(const CameraDescription& camera, double step_s);

  /// Begins the next step; to be called once for each step, in order. True if the shutter is open in it: then
  /// record() must follow.
  bool nextStep() {
    index_ = index_ + 1 == period_ ? 0 : index_ + 1;
    ++step_;
    return index_ < length_;
  }
  /// Records the state in the step that nextStep() has begun.
  void record(const ExposureSample& sample);
  /// Exposures that have ended; each is handed out once.
  std::vector<Exposure> take() { return std::exchange(ended_, {}); }

 private:
  double step_s_;
  std::uint64_t period_, length_;  ///< Frame period and exposure in steps.
  std::uint64_t index_;            ///< Index of the present step in its period.
  std::uint64_t step_{0};          ///< Number of steps begun.
  std::uint64_t frame_{0};
  Exposure open_;
  std::vector<Exposure> ended_;
};

}  // namespace kerfbench::twin
