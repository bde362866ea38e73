// SPDX-License-Identifier: Apache-2.0
#include "hil/app/instrument_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "hil/cli/program.h"

namespace kerfbench::app {

void becomeInstrument(const std::filesystem::path& bin_dir, const std::string& command, char** argv) {
  const std::filesystem::path program = bin_dir / cli::kInstrumentProgram;
  ::execv(program.c_str(), argv);
  const int error = errno;
  if (error != ENOENT) throw std::system_error(error, std::generic_category(), program.string());
  throw InstrumentMissing(fmt::format("kerfbench {} is in {}, which is not built: ./bench setup builds it",
                                      command, cli::kInstrumentProgram));
}

}  // namespace kerfbench::app
