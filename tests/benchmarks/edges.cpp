// SPDX-License-Identifier: Apache-2.0
// Recordings of any size, for `./bench benchmark --page`, which shows how reading them grows with their
// edges.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "hil/base/number_from.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"
#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {
namespace {

namespace fs = std::filesystem;

const fs::path kScenario = fs::path(KERFBENCH_SOURCE_DIR) / "fixtures/scenarios/native/label-on-belt.yaml";
const fs::path kBin = fs::path(KERFBENCH_BINARY_DIR) / "bin";

/// Edges of all pins that the machine has wires for.
std::uint64_t edgesOf(const source::PinRecording& recording) {
  std::uint64_t edges = recording.sensors.size();
  for (const PinEvent& event : recording.outputs.streamed())
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

int read(const fs::path& path) {
  const scenario::Case test_case = scenario::readCase(kScenario, kBin.parent_path() / "firmware");
  return tell(source::readVcd(path, test_case.machine.signals));
}

}  // namespace
}  // namespace kerfbench::benchmarks

int main(int argc, char** argv) {
  using namespace kerfbench;
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (what == "read" && argc == 3) return benchmarks::read(argv[2]);
    const auto edges = argc > 2 ? base::numberFrom<std::uint64_t>(argv[2]) : std::nullopt;
    if (what == "write" && argc == 4 && edges) return benchmarks::write(*edges, argv[3]);
    std::fprintf(stderr, "usage: kerfbench-edges write EDGES FILE | kerfbench-edges read FILE\n");
    return 64;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "kerfbench-edges: %s\n", e.what());
    return 2;
  }
}
