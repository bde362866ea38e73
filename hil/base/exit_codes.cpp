// SPDX-License-Identifier: Apache-2.0
#include "hil/base/exit_codes.h"

#include <algorithm>
#include <array>

namespace kerfbench::base {

int worstExitCode(int a, int b) {
  constexpr std::array kGravity{0, 4, 1, 3, kExitInput, kExitBroken};
  const auto rank = [&](int code) { return std::ranges::find(kGravity, code) - kGravity.begin(); };
  return rank(a) >= rank(b) ? a : b;
}

}  // namespace kerfbench::base
