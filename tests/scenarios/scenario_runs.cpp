// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/scenario_runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace kerfbench::test {
namespace fs = std::filesystem;

ProgramRun program(const std::string& name, const std::string& arguments) {
  const fs::path path = fs::path(KERFBENCH_BINARY_DIR) / "bin" / name;
  const std::string command = fmt::format("'{}' {} 2>&1", path.string(), arguments);
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("popen failed");
  ProgramRun run;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    run.output.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

ProgramRun kerfbench(const std::string& arguments) {
  const bool runs = arguments.starts_with("run ") || arguments.starts_with("replay ");
  const bool says =
      arguments.find("-j") != std::string::npos || arguments.find("--jobs") != std::string::npos;
  return program("kerfbench", runs && !says ? arguments + " --jobs 1" : arguments);
}

namespace {

/// Copies all verdicts below a folder, for the test verdict_schema (tests/results).
void keepVerdicts(const fs::path& folder) {
  const char* const kept = std::getenv("KERFBENCH_VERDICTS");
  if (kept == nullptr) return;
  int count = 0;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.path().filename() != "verdict.json") continue;
    const fs::path copy = fs::path(kept) / fmt::format("{}-{}.json", folder.filename().string(), ++count);
    if (!fs::copy_file(entry.path(), copy, error)) ADD_FAILURE() << copy << ": " << error.message();
  }
}

}  // namespace

ScratchFolder::ScratchFolder() {
  std::string pattern = (fs::path(testing::TempDir()) / "kerfbench.XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  keepVerdicts(path_);
  fs::remove_all(path_, ignored);
}

fs::path releaseImage(const std::string& name) { return fs::path(KERFBENCH_BINARY_DIR) / "firmware" / name; }

fs::path fixture(const std::string& name) { return fs::path(KERFBENCH_SOURCE_DIR) / "fixtures" / name; }

fs::path scenarioWith(const std::string& base, const std::string& keys, const ScratchFolder& scratch) {
  const fs::path path = scratch.path() / "variant.yaml";
  std::ofstream(path) << fmt::format("extends: '{}'\n{}", fixture("scenarios/" + base).string(), keys);
  return path;
}

ProgramRun fastRunOf(const fs::path& scenario, const ScratchFolder& scratch, const std::string& options) {
  return kerfbench(fmt::format("run '{}' --no-pictures --twin fast {} --results-dir '{}'", scenario.string(),
                               options, scratch.path().string()));
}

std::string textOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

nlohmann::json verdictOf(const fs::path& results) {
  const fs::path latest = results / "latest";
  std::ifstream file((fs::exists(latest) ? latest : results) / "verdict.json");
  return nlohmann::json::parse(file);
}

std::vector<std::string> checksThat(const nlohmann::json& verdict, const std::string& which) {
  std::vector<std::string> names;
  for (const auto& check : verdict.at("checks")) {
    if (check.at("verdict") == which) names.push_back(check.at("name"));
  }
  return names;
}

}  // namespace kerfbench::test
