// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace kerfbench::app {

/// There is no kerfbench-instrument; what() says how to build it.
class InstrumentMissing : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Lets kerfbench-instrument in `bin_dir`, which has the code of `command`, take this process over with the
/// same command line.
/// @throws InstrumentMissing, std::system_error if it is there and cannot be started.
[[noreturn]] void becomeInstrument(const std::filesystem::path& bin_dir, const std::string& command,
                                   char** argv);

}  // namespace kerfbench::app
