// SPDX-License-Identifier: Apache-2.0
#include "hil/app/other_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "hil/base/installation.h"
#include "hil/cli/program.h"

namespace kerfbench::app {

void becomeProgram(const std::filesystem::path& program, const std::string& command, char** argv) {
  ::execv(program.c_str(), argv);
  const int error = errno;
  if (error != ENOENT) throw std::system_error(error, std::generic_category(), program.string());
  const std::string name = program.filename().string();
  // Packages have the names of their programs, but for that of the first.
  const std::string advice =
      base::isInstalled(program.parent_path())
          ? fmt::format("installed: install the package {}", name == cli::kWindowProgram ? name : "kerfbench")
          : fmt::format("built: ./bench {} builds it", command);
  throw ProgramMissing(fmt::format("kerfbench {} is in {}, which is not {}", command, name, advice));
}

}  // namespace kerfbench::app
