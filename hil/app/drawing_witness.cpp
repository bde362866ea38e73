// SPDX-License-Identifier: Apache-2.0
#include "hil/app/drawing_witness.h"

#include <fmt/format.h>

#include <cstdio>
#include <vector>

#include "hil/base/terminal.h"
#include "hil/dieline/geometry.h"
#include "hil/judge/conclude.h"
#include "hil/witness/witness.h"

namespace kerfbench::app {

std::optional<int> refusedByWitness(scenario::Case& test_case, const std::string& folder_name,
                                    const judge::RunOptions& options, base::Stopwatch& stopwatch,
                                    base::Console& console) {
  const scenario::Scenario& scenario = test_case.scenario;
  if (!scenario.witness_required) return std::nullopt;
  const witness::Testimony testimony =
      witness::testimonyOf(*test_case.dieline, scenario.drawing, witness::witnessBeside(options.bin_dir));
  stopwatch.lap("second reader of the drawing");
  switch (testimony.kind) {
    case witness::Testimony::Kind::kAgrees:
      test_case.witness = testimony.sentences.front();
      console.say("  " + test_case.witness);
      return std::nullopt;
    case witness::Testimony::Kind::kParts: {
      std::vector<std::string> problems;
      for (const std::string& sentence : testimony.sentences)
        problems.push_back(fmt::format("drawing {}: {}", scenario.dieline.filename().string(), sentence));
      return judge::concludeUnrun(test_case, folder_name, problems, options, stopwatch, console);
    }
    case witness::Testimony::Kind::kMissing:
    case witness::Testimony::Kind::kBroken:
      break;
  }
  for (const std::string& sentence : testimony.sentences)
    base::toTerminal(
        stderr, fmt::format("{}: dieline.witness is required, and {}\n", scenario.path.string(), sentence));
  return witness::exitCodeOf(testimony.kind);
}

}  // namespace kerfbench::app
