// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/twin_cameras.h"

#include <utility>
#include <vector>

#include "hil/camera/twin/twin_frames.h"
#include "hil/run/cut_on_twin.h"

namespace kerfbench::test {

std::unique_ptr<camera::FrameSource> TwinCameras::spotFrames(double from_s, double to_s, int threads) {
  std::vector<twin::Exposure> exposures = twin_.takeExposures();
  std::erase_if(exposures, [&](const twin::Exposure& e) { return e.start_s < from_s || e.start_s > to_s; });
  const twin::MachineDescription& machine = case_.machine;
  return std::make_unique<camera::TwinFrameSource>(
      twin::SpotCamera(machine.spot_camera, case_.scenario.print, machine.glow_gray_per_w,
                       case_.scenario.seed),
      std::move(exposures), threads);
}

std::unique_ptr<camera::TileSource> TwinCameras::kerfTiles(int threads) {
  camera::TwinTileOptions options;
  options.threads = threads;
  return std::make_unique<camera::TwinTileSource>(
      run::kerfTiles(case_, case_.machine, twin_.sheet(), options));
}

}  // namespace kerfbench::test
