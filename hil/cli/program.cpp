// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/program.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "hil/base/atomic_file.h"
#include "hil/base/freed_memory.h"

namespace kerfbench::cli {

std::filesystem::path binDir() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

int guardedMain(const std::function<int()>& work) {
  base::keepFreedMemory();
  try {
    return work();
  } catch (const base::FolderError& e) {
    std::fputs(fmt::format("kerfbench: {}\n", e.what()).c_str(), stderr);
    return base::kExitInput;
  } catch (const std::exception& e) {
    std::fputs(fmt::format("kerfbench: the bench itself broke: {}\n", e.what()).c_str(), stderr);
    return base::kExitBroken;
  }
}

}  // namespace kerfbench::cli
