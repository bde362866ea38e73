// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hil/calibrate/marks/mark_job.h"
#include "twin/description/fidelity.h"
#include "twin/description/imperfections.h"

namespace kerfbench::head_service {

/// Machine, firmware and speeds with which marks are cut.
struct MarkCutting {
  std::filesystem::path machine;  ///< Machine file.
  std::string firmware{"{source: native, image: controller-native-galvo, mcu: native, baud: 2000000}"};
  double mark_speed_mm_s{300};
  double jump_speed_mm_s{400};
  double acceleration_mm_s2{200e3};
  double beam_radius_mm{0.105};  ///< 1/e²: the energy that cuts through follows.
  twin::Preset imperfections{twin::Preset::kStatic};
  std::uint64_t seed{1};  ///< Seed by which the machine that cuts is sampled.
  twin::Fidelity fidelity{twin::Fidelity::kFast};
};

/// A scenario that cuts a job on the twin, the sheet at rest where the job says. The drawing is `dieline`,
/// next to the scenario or absolute. It is a scenario as any other: `run` runs it and holds the marks against
/// where they were wanted.
std::string markScenario(const calibrate::MarkJob& job, const std::filesystem::path& dieline,
                         const MarkCutting& cutting);

}  // namespace kerfbench::head_service
