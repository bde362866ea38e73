// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <system_error>

#include "hil/base/atomic_file.h"
#include "hil/base/freed_memory.h"
#include "hil/base/terminal.h"

namespace kerfbench::cli {

std::filesystem::path binDir() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

std::filesystem::path usualResults() {
  const char* const here = "results";
  std::error_code ignored;
  if (::access(std::filesystem::exists(here, ignored) ? here : ".", W_OK) == 0) return here;
  const auto from = [](const char* variable) {
    const char* value = std::getenv(variable);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  // The specification has relative ones ignored.
  if (from("XDG_STATE_HOME").is_absolute()) return from("XDG_STATE_HOME") / "kerfbench" / here;
  if (from("HOME").is_absolute()) return from("HOME") / ".local" / "state" / "kerfbench" / here;
  return here;
}

int guardedMain(const std::function<int()>& work) {
  base::keepFreedMemory();
  try {
    return work();
  } catch (const base::FolderError& e) {
    base::toTerminal(stderr, fmt::format("kerfbench: {}\n", e.what()));
    return base::kExitInput;
  } catch (const std::filesystem::filesystem_error& e) {
    // Only a name that was given can be too long, or lead in a circle.
    const bool is_name =
        e.code() == std::errc::too_many_symbolic_link_levels || e.code() == std::errc::filename_too_long;
    base::toTerminal(stderr, is_name
                                 ? fmt::format("kerfbench: {}: {}\n", e.path1().string(), e.code().message())
                                 : fmt::format("kerfbench: the bench itself broke: {}\n", e.what()));
    return is_name ? base::kExitInput : base::kExitBroken;
  } catch (const std::exception& e) {
    base::toTerminal(stderr, fmt::format("kerfbench: the bench itself broke: {}\n", e.what()));
    return base::kExitBroken;
  }
}

}  // namespace kerfbench::cli
