// SPDX-License-Identifier: Apache-2.0
// Share of stated intervals that contain the truth: inspect_coverage [CASES [FIRST_SEED]]
#include <cstdio>
#include <cstdlib>

#include "tests/hil/inspect/drawn_evidence.h"

int main(int argc, char** argv) {
  using kerfbench::inspect::testing::Coverage;
  const int cases = argc > 1 ? std::atoi(argv[1]) : 1000;
  const auto first = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  if (cases < 1) return 64;
  const Coverage c = kerfbench::inspect::testing::measureCoverage(first, cases);
  const auto print = [](const char* name, const Coverage::Count& count) {
    std::printf("%-28s %5.1f %% of %d\n", name, 100.0 * count.share(), count.cases);
  };
  print("worst deviation", c.worst);
  print("worst deviation of a line", c.entity_worst);
  print("RMS deviation", c.rms);
  print("kerf width", c.width);
  print("drift", c.drift);
  print("largest drift", c.worst_drift);
  std::printf("U of the worst deviation at most %.2f um\n", 1e3 * c.largest_U_mm);
  std::printf("U by budget / by simulation: 5 %% %.2f, median %.2f, 95 %% %.2f\n",
              c.budget_ratio[c.budget_ratio.size() / 20], c.budget_ratio[c.budget_ratio.size() / 2],
              c.budget_ratio[c.budget_ratio.size() * 19 / 20]);
  std::printf(
      "PASS of %d bad ones (>= 0.055 mm): %d; FAIL of %d good ones (<= 0.040 mm): %d, not proven: %d\n",
      c.bad, c.wrong_pass, c.good, c.wrong_fail, c.unproven_good);
  return 0;
}
