// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

namespace kerfbench::hil {

/// Does the work for a scenario and returns its exit code. Bad input of the user is told in his words on
/// standard error: kExitInput. A model that has left the realm of numbers says nothing about the firmware:
/// time and joint on standard error, kExitBroken. Anything else passes through.
int guarded(const std::filesystem::path& scenario, const std::function<int()>& work);

/// Of several runs the gravest counts.
int gravest(int a, int b);

}  // namespace kerfbench::hil
