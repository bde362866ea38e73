// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::planner::test {

inline const std::string kPowerFolder = std::string(KERFBENCH_SOURCE_DIR) + "/fixtures/power/";
inline Material steel() { return readMaterial(kPowerFolder + "mild-steel.yaml"); }
inline LaserTube tube() { return readLaser(kPowerFolder + "co2-tube-80w.yaml"); }
inline std::shared_ptr<const PowerModel> steelModel(double depth_mm) {
  return std::make_shared<PowerModel>(steel(), tube(), PowerWish{0.2, depth_mm, std::nullopt});
}

}  // namespace kerfbench::planner::test
