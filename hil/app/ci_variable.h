// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::app {

/// Whether a CI runs this program, as its environment variable CI tells (GitHub, GitLab and most others set
/// it to true). `value`: of that variable, null where it is not set; neither an empty one nor "false" counts.
bool isCi(const char* value);

}  // namespace kerfbench::app
