// SPDX-License-Identifier: Apache-2.0
// Prints what the twin computes, for a comparison of builds.
#include <cstdio>
#include <exception>

#include "tests/determinism/twin_digest.h"

int main() {
  using namespace kerfbench::determinism;
  try {
    for (const TwinRun& run : allRuns()) {
      std::printf("%s: %s\n", nameOf(run).c_str(), textOf(digestOf(run)).c_str());
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "twin-digest: %s\n", e.what());
    return 2;
  }
  return 0;
}
