// SPDX-License-Identifier: Apache-2.0
#include "hil/app/other_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace kerfbench::app {

void becomeProgram(const std::filesystem::path& program, const std::string& command, char** argv) {
  ::execv(program.c_str(), argv);
  const int error = errno;
  if (error != ENOENT) throw std::system_error(error, std::generic_category(), program.string());
  throw ProgramMissing(fmt::format("kerfbench {} is in {}, which is not built: ./bench {} builds it", command,
                                   program.filename().string(), command));
}

}  // namespace kerfbench::app
