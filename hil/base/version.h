// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::base {

/// The bench's own version: "0.1.0".
const char* version();

}  // namespace kerfbench::base
