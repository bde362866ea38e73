// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/host.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>

namespace kerfbench::guest {

void skipWithoutQemu() {
  constexpr int kSkipped = 77;  // Value of SKIP_RETURN_CODE in CMakeLists.txt.
  if (std::system("command -v qemu-system-x86_64 >/dev/null") == 0) return;
  fmt::print("SKIPPED: qemu-system-x86_64 is not installed. Debian: qemu-system-x86\n");
  std::exit(kSkipped);
}

bool runGuest(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace kerfbench::guest
