// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::base {

/// For programs whose pictures or matrices of megabytes come and go by the thousand: freed memory stays with
/// the process. Given back to the system each time, an eighth of a run's time goes into getting zeroed pages
/// again. Does nothing without glibc. Call it once, first in main().
void keepFreedMemory();

}  // namespace kerfbench::base
