// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hil/camera/machine_cameras.h"
#include "hil/scenario/case.h"
#include "twin/cutter/twin.h"

namespace kerfbench::test {

/// The cameras of a twin that a test moves itself. Both arguments must outlive it.
class TwinCameras final : public camera::MachineCameras {
 public:
  TwinCameras(const scenario::Case& test_case, twin::Twin& twin) : case_(test_case), twin_(twin) {}
  std::unique_ptr<camera::FrameSource> spotFrames(double from_s, double to_s, int threads) override;
  std::unique_ptr<camera::TileSource> kerfTiles(int threads) override;

 private:
  const scenario::Case& case_;
  twin::Twin& twin_;
};

}  // namespace kerfbench::test
