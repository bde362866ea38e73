// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace kerfbench::app {

/// A program to which kerfbench hands over is not there; what() says how to build it.
class ProgramMissing : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Lets a program, which has the code of `command`, take this process over with the same command line.
/// @throws ProgramMissing, std::system_error if it is there and cannot be started.
[[noreturn]] void becomeProgram(const std::filesystem::path& program, const std::string& command,
                                char** argv);

}  // namespace kerfbench::app
