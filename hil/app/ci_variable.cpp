// SPDX-License-Identifier: Apache-2.0
#include "hil/app/ci_variable.h"

#include <string_view>

namespace kerfbench::app {

bool isCi(const char* value) {
  const std::string_view text = value != nullptr ? value : "";
  return !text.empty() && text != "false";
}

}  // namespace kerfbench::app
