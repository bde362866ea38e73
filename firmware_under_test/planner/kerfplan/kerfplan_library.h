// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace kerfbench::planner {

/// The library that is shipped with the source of this build, or an empty path where there is none.
std::string shippedLibrary();

/// Command `kerfplan library list|show|check`: the materials and lasers of a folder.
class LibraryCommand {
 public:
  explicit LibraryCommand(CLI::App& app);
  /// Runs the command; true if it was given. @throws PowerError that names all that is wrong.
  bool run() const;

 private:
  struct Options;
  CLI::App* list_;
  CLI::App* show_;
  CLI::App* check_;
  std::shared_ptr<Options> options_;
};

}  // namespace kerfbench::planner
