// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/base/console.h"
#include "hil/suite/run_suite.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::suite {

/// A folder with a plan, scenarios that can be read, and a program in the place of kerfbench that gives a
/// verdict without a run: what is tested with it is the suite and not what runs.
class SmallSuite {
 public:
  SmallSuite() {
    std::filesystem::create_directories(folder() / "bin");
    std::filesystem::create_directories(folder() / "firmware");
    put("firmware/controller-native", "an image");
    put("bin/kerfbench", kProgram);
    std::filesystem::permissions(program(), std::filesystem::perms::owner_all);
  }

  [[nodiscard]] const std::filesystem::path& folder() const { return temp_.path(); }
  [[nodiscard]] std::filesystem::path program() const { return folder() / "bin/kerfbench"; }
  [[nodiscard]] std::filesystem::path plan() const { return folder() / "plan.yaml"; }
  std::filesystem::path put(const std::string& name, const std::string& text) const {
    return temp_.write(name, text);
  }
  /// A scenario that names no image but a dummy, which nobody loads.
  void scenario(const std::string& name, const std::string& keys = "") const {
    put(name + ".yaml",
        fmt::format("extends: '{}'\nname: {}\n{}",
                    base::fixture("scenarios/native/label-on-belt.yaml").string(), name, keys));
  }
  void plan(const std::string& text) const { put("plan.yaml", "version: 1\nname: release\n" + text); }
  /// Lines of shell that the program does for runs of this name: verdict=FAIL, exit 2, kill -9 $$.
  void act(const std::string& scenario, const std::string& lines) const {
    put("bin/kerfbench." + scenario, lines);
  }
  /// "SCENARIO SEED" of each call of the program so far, a line each.
  [[nodiscard]] std::string calls() const { return base::contentOf(folder() / "bin/kerfbench.calls"); }

  [[nodiscard]] SuiteOptions options() const {
    SuiteOptions options;
    options.plan = plan();
    options.results_dir = folder() / "results";
    options.bin_dir = folder() / "bin";
    options.program = program();
    return options;
  }
  [[nodiscard]] std::filesystem::path latest() const {
    return std::filesystem::canonical(folder() / "results/release/latest");
  }
  [[nodiscard]] std::string summaryText() const { return base::contentOf(latest() / "summary.json"); }
  [[nodiscard]] nlohmann::json summary() const { return nlohmann::json::parse(summaryText()); }
  /// Outcomes of the runs in their order, with blanks between.
  [[nodiscard]] std::string outcomes() const {
    std::string text;
    const nlohmann::json all = summary();
    for (const auto& run : all.at("runs"))
      text += (text.empty() ? "" : ", ") + run.at("outcome").get<std::string>();
    return text;
  }

 private:
  static constexpr const char* kProgram = R"sh(#!/bin/sh
me=$0
name=$(basename "$2" .yaml)
shift 2
seed=1
while [ $# -gt 0 ]; do
  case $1 in --output) out=$2 ;; --seed) seed=$2 ;; esac
  shift
done
echo "$name $seed" >> "$me.calls"
verdict=PASS check=PASS
[ ! -e "$me.$name" ] || . "$me.$name"
mkdir -p "$out"
cat > "$out/verdict.json" <<END
{"schema_version": 1, "verdict": "$verdict", "summary": "A sentence.", "likely_cause": "", "digest": "d-$name-$seed",
 "inputs_digest": "i", "firmware": "image", "versions": {"firmware sha256": "00"}, "seed": $seed,
 "model": {"imperfections": "ideal", "twin": "fast"}, "virtual_s": 2.5, "problems": [], "reservations": [],
 "checks": [
  {"name": "path", "title": "Path", "verdict": "$verdict", "value": 0.03, "unit": "mm", "limit": 0.05,
   "limit_is": "upper", "expanded_uncertainty": 0.004, "subject": "unit 0, E1", "explanation": ""},
  {"name": "gate_lag", "title": "Gate", "verdict": "$check", "value": null, "unit": "ms", "limit": 0.5,
   "limit_is": "upper", "expanded_uncertainty": 0.1, "subject": "", "explanation": ""}]}
END
case $verdict in PASS) exit 0 ;; FAIL) exit 1 ;; INVALID) exit 3 ;; *) exit 4 ;; esac
)sh";
  base::TempFolder temp_;
};

/// Runs a suite in silence.
inline int runQuietly(const SuiteOptions& options) {
  base::Console console(true);
  testing::internal::CaptureStdout();
  int code = -1;
  try {
    code = runSuite(options, console);
  } catch (...) {
    (void)testing::internal::GetCapturedStdout();
    throw;
  }
  (void)testing::internal::GetCapturedStdout();
  return code;
}

/// What a call throws, as text; fails if it does not.
template <typename Error, typename Call>
std::string errorOf(const Call& call) {
  try {
    (void)call();
  } catch (const Error& e) {
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace kerfbench::suite
