// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "hil/doctor/doctor.h"

namespace kerfbench::doctor {

/// Findings about the cameras of this computer alone.
void addCameraFindings(const std::vector<camera::CameraListing>& cameras,
                       std::vector<DoctorFinding>& findings);
/// Findings about what a case with a real spot camera needs: device, format, size, rate and settings.
void addCameraNeeds(const scenario::Case& test_case, const std::vector<camera::CameraListing>& cameras,
                    std::vector<DoctorFinding>& findings);
nlohmann::ordered_json camerasJson(const std::vector<camera::CameraListing>& cameras);

}  // namespace kerfbench::doctor
