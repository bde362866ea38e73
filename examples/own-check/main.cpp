// SPDX-License-Identifier: Apache-2.0
// own-check SCENARIO [REST_MS]: lets the own source move the scenario's machine, keeps its pins as
// own-pins.vcd, and judges them. own-check SCENARIO --pins FILE: judges recorded pins, as of
// results/NAME/latest/pins.vcd.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/judge/pin_wiring.h"
#include "hil/run/model_machine.h"
#include "hil/scenario/case.h"
#include "light_at_rest.h"
#include "pattern_source.h"

namespace {

using namespace kerfbench;

constexpr double kLimit_ms = 2.0;
constexpr const char* kPins = "own-pins.vcd";

/// Runs the own source and the model of the machine in lockstep, as `kerfbench run` does with a release.
source::PinRecording runOnModel(const scenario::Case& test_case, double rest_s) {
  own::PatternSource pattern(test_case.machine.signals, rest_s);
  run::ModelMachine machine(test_case, scenario::sampledMachine(test_case), pattern.info().rate,
                            {.record_exposures = false});
  run::RecordedRun run = machine.run(pattern, nullptr, run::LockstepOptions{}, {});
  for (const std::string& problem : run.problems) std::printf("  %s\n", problem.c_str());
  source::writeVcd(kPins, run.recording, test_case.machine.signals);
  std::printf("  pins: %s\n", kPins);
  return std::move(run.recording);
}

int judgePins(const std::vector<std::string>& words) {
  const scenario::Case test_case = scenario::readCase(words.at(0), std::filesystem::path(OWN_IMAGES));
  const bool recorded = words.size() == 3 && words[1] == "--pins";
  const source::PinRecording recording =
      recorded ? source::readVcd(words[2], test_case.machine.signals)
               : runOnModel(test_case, words.size() > 1 ? 1e-3 * std::stod(words[1]) : 0.0);
  const inspect::Check check = own::lightAtRest(recording, judge::pinWiring(test_case), kLimit_ms);
  std::printf("%s: %s, %.3f ms of at most %.3f ms, at %.4f s\n", check.name.c_str(),
              std::string(inspect::verdictName(check.verdict)).c_str(), check.value, check.limit,
              check.where.time_s);
  return inspect::exitCode(check.verdict);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty()) {
    std::fputs("own-check SCENARIO [REST_MS] | own-check SCENARIO --pins FILE\n", stderr);
    return 64;
  }
  return judgePins(words);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 65;
}
