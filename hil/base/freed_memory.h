// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::base {

/// Keeps freed memory with the process, for programs whose pictures or matrices of megabytes come and go by
/// the thousand. Given back to the system each time, an eighth of a run's time goes into getting zeroed pages
/// again. Does nothing without glibc. Call it once, first in main().
void keepFreedMemory();

}  // namespace kerfbench::base
