// SPDX-License-Identifier: Apache-2.0
// Recordings of any size, for `./bench benchmark --page`, which shows how reading and judging them grows with
// their edges.
#include <sys/resource.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <limits>
#include <string>

#include "hil/base/number_from.h"
#include "hil/scenario/case.h"
#include "hil/source/analyser/sr_file.h"
#include "hil/source/vcd.h"
#include "tests/benchmarks/pin_account.h"
#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {
namespace {

namespace fs = std::filesystem;

const fs::path kScenario = fs::path(KERFBENCH_SOURCE_DIR) / "fixtures/scenarios/native/label-on-belt.yaml";
const fs::path kBin = fs::path(KERFBENCH_BINARY_DIR) / "bin";

/// Edges of all pins that the machine has wires for.
std::uint64_t edgesOf(const source::PinRecording& recording) {
  std::uint64_t edges = recording.sensors.size();
  for (const PinEvent& event : recording.outputs)
    edges += static_cast<std::uint64_t>(__builtin_popcount(event.changed));
  return edges;
}

int tell(const source::PinRecording& recording) {
  std::printf("%llu edges\n", static_cast<unsigned long long>(edgesOf(recording)));
  return 0;
}

int write(std::uint64_t least_edges, const fs::path& path) {
  const RecordedRun run = record(kScenario, kBin);
  const std::uint64_t edges_of_one = edgesOf(repeated(run, 1));
  const source::PinRecording recording = repeated(run, least_edges / edges_of_one + 1);
  source::writeVcd(path, recording, run.machine.signals);
  return tell(recording);
}

scenario::Case machineCase() { return scenario::readCase(kScenario, kBin.parent_path() / "firmware"); }

source::PinRecording readAny(const fs::path& path, const scenario::Case& test_case) {
  const auto progress = [](double /*now_s*/, const std::string& what) {
    std::fprintf(stderr, "\r%s ", what.c_str());
  };
  const SignalMap& map = test_case.machine.signals;
  return path.extension() == ".sr" ? source::readSr(path, map, {}, progress)
                                   : source::readVcd(path, map, progress);
}

/// Fails if the program has taken more than `most_mib` of memory at any time.
int read(const fs::path& path, std::uint64_t most_mib) {
  const int code = tell(readAny(path, machineCase()));
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto peak_mib = static_cast<std::uint64_t>(used.ru_maxrss) / 1024;
  if (peak_mib <= most_mib) return code;
  std::fprintf(stderr, "kerfbench-edges: %llu MiB of memory\n", static_cast<unsigned long long>(peak_mib));
  return 1;
}

/// Positions and timing of all axes.
int judge(const fs::path& path) {
  const scenario::Case test_case = machineCase();
  const source::PinRecording recording = readAny(path, test_case);
  const PinAccount account = accountOf(recording, test_case);
  for (const PulseTiming& axis : account.pins.pulses)
    std::printf("%s: %llu pulses, set-up at least %.2f us, %llu of them short\n", axis.axis.c_str(),
                static_cast<unsigned long long>(axis.pulses), 1e6 * axis.min_setup_s,
                static_cast<unsigned long long>(axis.setup_violations));
  std::printf("mirrors at %d and %d steps, the laser lit %zu times\n", account.end[0], account.end[1],
              account.pins.light.size());
  return tell(recording);
}

}  // namespace
}  // namespace kerfbench::benchmarks

int main(int argc, char** argv) {
  using namespace kerfbench;
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (what == "read" && argc == 3)
      return benchmarks::read(argv[2], std::numeric_limits<std::uint64_t>::max());
    const auto most_mib = argc > 3 ? base::numberFrom<std::uint64_t>(argv[3]) : std::nullopt;
    if (what == "read" && argc == 4 && most_mib) return benchmarks::read(argv[2], *most_mib);
    if (what == "judge" && argc == 3) return benchmarks::judge(argv[2]);
    const auto edges = argc > 2 ? base::numberFrom<std::uint64_t>(argv[2]) : std::nullopt;
    if (what == "write" && argc == 4 && edges) return benchmarks::write(*edges, argv[3]);
    std::fprintf(stderr, "usage: kerfbench-edges write EDGES FILE | read FILE [MOST_MIB] | judge FILE\n");
    return 64;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "kerfbench-edges: %s\n", e.what());
    return 2;
  }
}
