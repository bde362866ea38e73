// SPDX-License-Identifier: Apache-2.0
#include "hil/base/version.h"

namespace kerfbench::base {

const char* version() { return KERFBENCH_VERSION; }

}  // namespace kerfbench::base
