// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::suite {

/// Names of the runs that were not as expected in a suite, broken or not run, in their order.
/// @throws base::InputError that names the folder: its summary is not there, broken, or one of another
/// version; or all runs were as expected.
std::vector<std::string> namesNotAsExpected(const std::filesystem::path& folder);

}  // namespace kerfbench::suite
