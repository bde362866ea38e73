// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace kerfbench::test {

/// Visible result of one call of the program.
struct ProgramRun {
  int exit_code{};
  std::string output;  ///< Standard output and standard error.
};

/// Runs a program of the build, or one by its absolute path, with these arguments in a shell, as a user
/// would.
ProgramRun program(const std::string& name, const std::string& arguments);
/// Runs the program of all commands. A run and a replay have one thread, unless the arguments say how many:
/// ctest runs as many tests at a time as there are cores.
ProgramRun kerfbench(const std::string& arguments);

/// A folder for the results of one test, empty at first, removed in the end. Its verdicts are validated
/// (tests/results).
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::filesystem::path fixture(const std::string& name);
/// A release that the build makes.
std::filesystem::path releaseImage(const std::string& name);
/// A scenario of its own in the folder: these keys beside those of the base, one of fixtures/scenarios.
std::filesystem::path scenarioWith(const std::string& base, const std::string& keys,
                                   const ScratchFolder& scratch);
/// Runs a scenario on the fast twin, without pictures; its results lie in the folder.
ProgramRun fastRunOf(const std::filesystem::path& scenario, const ScratchFolder& scratch,
                     const std::string& options = "");
/// Text of a file; empty if there is none.
std::string textOf(const std::filesystem::path& path);
/// Verdict of one run, or of the latest of a scenario.
nlohmann::json verdictOf(const std::filesystem::path& results);
/// Names of the checks with this verdict.
std::vector<std::string> checksThat(const nlohmann::json& verdict, const std::string& which);

}  // namespace kerfbench::test
